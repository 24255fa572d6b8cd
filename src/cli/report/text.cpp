#include "cli/report/text.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace hemi::cli {

namespace {

/// Characters rather than bytes, so that names with accents keep columns straight.
std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

} // namespace

Table::Table(std::vector<std::string> header, std::size_t left) : rows_{std::move(header)}, left_(left) {}

void Table::add(std::vector<std::string> row) {
    for (std::string& cell : row) {
        cell = printable(cell);
    }
    rows_.push_back(std::move(row));
}

std::string Table::text() const {
    std::vector<std::size_t> widths(rows_.front().size(), 0);
    for (const auto& row : rows_) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            widths[c] = std::max(widths[c], width_of(row[c]));
        }
    }
    std::string text;
    for (const auto& row : rows_) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            const std::string padding(widths[c] - width_of(row[c]), ' ');
            line += c == 0 ? "" : "  ";
            line += c < left_ ? row[c] + padding : padding + row[c];
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

std::string summary_line(std::string_view name, std::string_view value) {
    return fmt::format("{:<13} {}\n", name, value);
}

std::string value_text(double value) {
    return std::isfinite(value) ? number_text(value) : "-";
}

Json value_json(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
        throw IoError(fmt::format("standard output: {}", std::strerror(errno)));
    }
}

void print_json(const Json& object) {
    print(object.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n');
}

std::string PatchNames::describe(std::uint32_t patch) const {
    if (centres.empty()) {
        return fmt::format("patch {} ({})", number(patch), group(patch));
    }
    const Vec3& centre = centres[patch];
    return fmt::format("patch {} ({}, at {} {} {})", number(patch), group(patch), number_text(centre.x),
                       number_text(centre.y), number_text(centre.z));
}

Json PatchNames::json(std::uint32_t patch) const {
    Json object{{"index", number(patch)}, {"group", group(patch)}, {"centre", nullptr}};
    if (!centres.empty()) {
        const Vec3& centre = centres[patch];
        object["centre"] = {centre.x, centre.y, centre.z};
    }
    return object;
}

std::string towards_text(const std::optional<Vec3>& direction) {
    const auto tidy = [](double value) { return std::round(100.0 * value) / 100.0 + 0.0; };
    return direction
               ? fmt::format(", towards {} {} {}", tidy(direction->x), tidy(direction->y), tidy(direction->z))
               : std::string();
}

Json rows_json(std::span<const double> values, std::size_t columns) {
    Json rows = Json::array();
    for (std::size_t begin = 0; begin < values.size(); begin += columns) {
        const auto row = values.subspan(begin, columns);
        rows.push_back(Json(std::vector<double>(row.begin(), row.end())));
    }
    return rows;
}

} // namespace hemi::cli
