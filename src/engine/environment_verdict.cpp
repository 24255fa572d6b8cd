#include "engine/environment_verdict.hpp"

#include "hemi/matrix/repair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hemi {

namespace {

/// With Enclosure::automatic a scene is closed if no row's texels see more of the environment than this. A
/// little above the weight of the heaviest texel of 4 hemicubes of 64² texels (4 / (pi 64²) / 4 = 8e-5): a
/// single one may slip through where the edges of two walls meet.
constexpr double max_leak = 1e-4;

/// Rows that are asked by the exact rule: it takes some ten times as long as the standard one.
constexpr std::size_t most_exact = 4;

/// The most that the texels of a row may say.
double allowed(const EnvironmentEvidence& row) {
    return row.enclosed ? 0.0 : std::min(row.texels, std::max(0.0, row.remainder + row.error));
}

bool sees(const EnvironmentEvidence& row) {
    return !row.enclosed && (row.remainder > row.error || allowed(row) > max_leak);
}

} // namespace

double unoccluded_error(ExchangeRule rule) {
    return rule == ExchangeRule::exact ? 3e-5 : RepairSettings().unoccluded_error;
}

bool sees_environment(double share, Enclosure enclosure) {
    return enclosure == Enclosure::open || (enclosure == Enclosure::automatic && share > max_leak);
}

EnvironmentEvidence evidence_of(const RowView& row, bool hidden, ExchangeRule rule) {
    double sum = 0.0;
    double partly_hidden = 0.0; // F0 of them: V may be anything
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const auto value = static_cast<double>(row.values[k]);
        sum += value;
        if (row.visibility[k] != visibility_clear) {
            partly_hidden += value * visibility_clear / std::max(0.5, static_cast<double>(row.visibility[k]));
        }
    }
    const bool unknown = hidden || row.blocked > 0.0;
    return {.texels = row.environment,
            .remainder = 1.0 - row.blocked - sum,
            .error = unknown ? std::numeric_limits<double>::infinity()
                             : unoccluded_error(rule) * sum + partly_hidden};
}

bool is_open(std::span<const EnvironmentEvidence> rows, Enclosure enclosure,
             const std::function<EnvironmentEvidence(std::size_t)>& exact_evidence) {
    if (enclosure != Enclosure::automatic) {
        return enclosure == Enclosure::open;
    }
    if (std::any_of(rows.begin(), rows.end(), sees)) {
        return true;
    }
    std::vector<std::size_t> lacking;
    for (std::size_t k = 0; k < rows.size() && exact_evidence; ++k) {
        if (!rows[k].enclosed && std::isfinite(rows[k].error) &&
            rows[k].remainder > unoccluded_error(ExchangeRule::exact)) {
            lacking.push_back(k);
        }
    }
    const std::size_t asked = std::min(most_exact, lacking.size());
    std::partial_sort(lacking.begin(), lacking.begin() + static_cast<std::ptrdiff_t>(asked), lacking.end(),
                      [&](std::size_t a, std::size_t b) { return rows[a].remainder > rows[b].remainder; });
    return std::any_of(lacking.begin(), lacking.begin() + static_cast<std::ptrdiff_t>(asked),
                       [&](std::size_t k) { return sees(exact_evidence(k)); });
}

double environment_share(const EnvironmentEvidence& row, Enclosure enclosure, bool open) {
    if (enclosure == Enclosure::closed) {
        return row.texels;
    }
    if (row.enclosed) {
        return 0.0;
    }
    return open && (row.texels > 0.0 || row.remainder > row.error) ? std::max(0.0, row.remainder)
                                                                   : (open ? 0.0 : allowed(row));
}

} // namespace hemi
