#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/core/text.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// How results are written: tables for people, JSON for programs.
namespace hemi::cli {

using Json = nlohmann::ordered_json;

/// Columns padded to equal width; the first column to the left, numbers (all others) to the right.
class Table {
public:
    /// @param left  number of columns, from the first, that are set to the left.
    explicit Table(std::vector<std::string> header, std::size_t left = 1);
    void add(std::vector<std::string> row);
    [[nodiscard]] std::string text() const;

private:
    std::vector<std::vector<std::string>> rows_;
    std::size_t left_;
};

/// "name            value" lines, as summaries consist of.
[[nodiscard]] std::string summary_line(std::string_view name, std::string_view value);

/// Writes to standard output. @throws IoError when that fails, for example on a full disk.
void print(std::string_view text);
/// One JSON object and a line end; NaN and infinity become null, bytes that are not UTF-8 U+FFFD.
void print_json(const Json& object);

/// A number for tables; "-" where it is none.
[[nodiscard]] std::string value_text(double value);
/// The same for JSON: null where it is none.
[[nodiscard]] Json value_json(double value);

/// What is needed to speak of a patch: its group, and its centre where the geometry is known.
struct PatchNames {
    std::span<const std::string> groups;
    std::span<const std::uint32_t> group_of;
    std::span<const Vec3> centres;                ///< empty: not known
    std::span<const std::uint32_t> patch_of = {}; ///< of parts: the patches that they are parts of

    /// The number that a patch has for people.
    [[nodiscard]] std::uint32_t number(std::uint32_t patch) const {
        return patch_of.empty() ? patch : patch_of[patch];
    }

    [[nodiscard]] const std::string& group(std::uint32_t patch) const { return groups[group_of[patch]]; }
    /// "patch 12 (floor, at 0.1 0.2 0)"
    [[nodiscard]] std::string describe(std::uint32_t patch) const;
    /// {"index", "group", "centre"}, centre null where not known.
    [[nodiscard]] Json json(std::uint32_t patch) const;
};

/// ", towards 0 0.71 0.71" for a direction; empty where there is none.
[[nodiscard]] std::string towards_text(const std::optional<Vec3>& direction);

/// `values` as arrays of `columns`.
[[nodiscard]] Json rows_json(std::span<const double> values, std::size_t columns);

} // namespace hemi::cli
