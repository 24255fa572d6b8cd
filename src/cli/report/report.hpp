#pragma once

#include "cli/report/text.hpp"

#include <nlohmann/json.hpp>

#include <initializer_list>
#include <string>
#include <string_view>

namespace hemi::cli {

/// What a command reports of something, in both forms, each value written once: lines for people and the keys
/// of a JSON object for programs.
struct Report {
    std::string text;
    Json json = Json::object();

    /// Adds a summary line and the keys that hold the same values.
    void add(std::string_view name, std::string_view line, const Json& keys = Json::object());
    /// Adds what another report says.
    void add(const Report& more);

    /// A JSON object of these keys in this order, behind the name of its schema; all must be known.
    [[nodiscard]] Json select(std::string_view schema, std::initializer_list<const char*> keys) const;
};

/// Prints one of the two forms on standard output.
void show(const Report& report, bool json);

} // namespace hemi::cli
