#pragma once

#include "cli/report/text.hpp"

#include <nlohmann/json.hpp>

#include <initializer_list>
#include <string>
#include <string_view>

namespace hemi::cli {

/// What a command reports, as text and as JSON: summary lines for people, and the keys of a JSON object with
/// the same values for programs.
struct Report {
    std::string text;
    Json json = Json::object();

    /// Adds a summary line and the keys that hold the same values.
    void add(std::string_view name, std::string_view line, const Json& keys = Json::object());
    /// Adds the text and the keys of another report.
    void add(const Report& more);

    /// Makes the JSON object that a command prints: "schema", then these keys in this order, and no others.
    /// @throws Json::out_of_range if the report lacks one of them
    void select(std::string_view schema, std::initializer_list<const char*> keys);
};

/// Prints one of the two forms on standard output.
void show(const Report& report, bool json);

} // namespace hemi::cli
