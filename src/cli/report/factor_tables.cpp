#include "cli/report/factor_tables.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/baselines.hpp"
#include "hemi/matrix/product.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace hemi::cli {

namespace {

/// Factors to patches, largest first: what one row and one point have in common.
struct FactorList {
    std::vector<std::uint32_t> patches;
    std::vector<double> factors;

    void sort() {
        std::vector<std::size_t> order(patches.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [this](std::size_t a, std::size_t b) { return factors[a] > factors[b]; });
        FactorList sorted;
        for (const std::size_t k : order) {
            sorted.patches.push_back(patches[k]);
            sorted.factors.push_back(factors[k]);
        }
        *this = std::move(sorted);
    }

    /// A table, and the key "entries".
    /// @param single  whether the factors are 32-bit numbers, written as such
    [[nodiscard]] Report report(const PatchNames& names, bool single) const {
        Table table({"group", "patch", "F"});
        Json entries = Json::array();
        for (std::size_t k = 0; k < patches.size(); ++k) {
            const std::string& group = names.group(patches[k]);
            table.add({group, std::to_string(patches[k]), fmt::format("{:.9f}", factors[k])});
            entries.push_back({{"patch", patches[k]},
                               {"group", group},
                               {"factor", single ? Json(static_cast<float>(factors[k])) : Json(factors[k])}});
        }
        return {table.text(), {{"entries", entries}}};
    }
};

} // namespace

Report row_report(const FormFactors& factors, std::uint32_t index, const PatchNames& names) {
    const RowView row = factors.matrix.row(index);
    std::map<std::uint32_t, double> sums; // patches of a cluster may be there on their own as well
    visit_sources(factors.matrix, row, [&sums](std::uint32_t j, double factor) { sums[j] += factor; });
    FactorList list;
    for (const auto& [patch, factor] : sums) {
        list.patches.push_back(patch);
        list.factors.push_back(factor);
    }
    list.sort();
    Report report{fmt::format("row {}: what leaves {}\n", index, names.describe(index)),
                  {{"renderer", factors.provenance.renderer},
                   {"patches", factors.matrix.size()},
                   {"row", index},
                   {"group", names.group(index)}}};
    report.add({fmt::format("sum {:.9f}, environment share {:.9f}, back-face share {:.9f}\n\n", row.sum(),
                            row.environment, row.blocked),
                {{"sum", row.sum()}, {"environment", row.environment}, {"blocked", row.blocked}}});
    report.add(list.report(names, true));
    report.select("hemi/factors-row/1",
                  {"renderer", "patches", "row", "group", "entries", "sum", "environment", "blocked"});
    return report;
}

Report point_report(const LoadedScene& loaded, const std::array<double, 6>& at) {
    const Vec3 point(at[0], at[1], at[2]);
    const Vec3 normal(at[3], at[4], at[5]);
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) {
        throw InvalidArgument("--from-point: the normal must have a length");
    }
    const std::vector<double> to_parts = point_factors(loaded.mesh, point, normal / length, true);
    const PatchNames parts = loaded.names();
    std::vector<double> factors(loaded.patches().size(), 0.0);
    for (std::uint32_t part = 0; part < to_parts.size(); ++part) {
        factors[parts.number(part)] += to_parts[part];
    }
    FactorList list;
    for (std::uint32_t patch = 0; patch < factors.size(); ++patch) {
        if (factors[patch] > 0.0) {
            list.patches.push_back(patch);
            list.factors.push_back(factors[patch]);
        }
    }
    list.sort();
    const double sum = std::accumulate(list.factors.begin(), list.factors.end(), 0.0);
    Report report{fmt::format("what leaves a surface element at {} {} {}\n", number_text(point.x),
                              number_text(point.y), number_text(point.z)),
                  {{"patches", factors.size()},
                   {"point", {point.x, point.y, point.z}},
                   {"normal", {normal.x / length, normal.y / length, normal.z / length}}}};
    report.add({fmt::format("sum {:.9f}\n\n", sum), {{"sum", sum}}});
    report.add(list.report(loaded.patch_names(), false));
    report.select("hemi/factors-from-point/1", {"patches", "point", "normal", "entries", "sum"});
    return report;
}

std::string group_factors_text(const std::vector<std::string>& names, const GroupFactors& groups) {
    constexpr std::uint32_t max_columns = 10;
    if (groups.groups > max_columns) {
        Table table({"from", "to", "F"}, 2);
        for (std::uint32_t g = 0; g < groups.groups; ++g) {
            if (groups.areas[g] == 0.0) { // left out
                continue;
            }
            for (std::uint32_t h = 0; h < groups.groups; ++h) {
                const double factor = groups.factors[std::size_t{g} * groups.groups + h];
                if (factor > 0.0) {
                    table.add({names[g], names[h], fmt::format("{:.6f}", factor)});
                }
            }
            if (groups.environment[g] > 0.0) {
                table.add({names[g], "(environment)", fmt::format("{:.6f}", groups.environment[g])});
            }
            if (groups.blocked[g] > 0.0) {
                table.add({names[g], "(back faces)", fmt::format("{:.6f}", groups.blocked[g])});
            }
        }
        return table.text();
    }
    std::vector<std::string> header{"F from / to"};
    header.insert(header.end(), names.begin(), names.end());
    header.insert(header.end(), {"(environment)", "(back faces)", "area"});
    Table table(header);
    for (std::uint32_t g = 0; g < groups.groups; ++g) {
        std::vector<std::string> line{names[g]};
        if (groups.areas[g] == 0.0) { // left out
            line.resize(header.size() - 1, "-");
            line.push_back(number_text(0.0));
            table.add(line);
            continue;
        }
        for (std::uint32_t h = 0; h < groups.groups; ++h) {
            line.push_back(fmt::format("{:.6f}", groups.factors[std::size_t{g} * groups.groups + h]));
        }
        line.push_back(fmt::format("{:.6f}", groups.environment[g]));
        line.push_back(fmt::format("{:.6f}", groups.blocked[g]));
        line.push_back(number_text(groups.areas[g]));
        table.add(line);
    }
    return table.text();
}

Json group_factors_json(const std::vector<std::string>& names, const GroupFactors& groups) {
    return {{"groups", names},
            {"areas", groups.areas},
            {"factors", rows_json(groups.factors, groups.groups)},
            {"environment", groups.environment},
            {"blocked", groups.blocked}};
}

} // namespace hemi::cli
