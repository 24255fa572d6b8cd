#include "pipeline/patch_splits.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

/// What bends less than this share of the other way is not cut: half the width leaves a quarter of a bend,
/// and two cuts one after the other take more rows than one in four.
constexpr double least_share = 0.25;
/// No patch becomes more slender than this by a cut that makes its short way shorter: the row of a needle
/// needs many sample points.
constexpr double most_slender = 16.0;
/// Values of patches that meet at a vertex differ by no more than this share where nothing stands between
/// them: some may show the light of a mesh before.
constexpr double same_light = 0.1;

/// Corners of the front's quadrilateral, along u and v.
constexpr std::array<std::array<std::int64_t, 2>, 4> corner_steps{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

} // namespace

PatchSplits::PatchSplits(const PatchMesh& mesh) : mesh_(mesh), finest_(mesh.surfaces().size()) {
    parts_.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t s = mesh.surface_of()[i];
        const std::uint32_t local = (i - mesh.first_patch(s)) % mesh.patches_per_side(s);
        parts_.push_back(mesh.parts(s).empty() ? GridPart{0, 0, local} : mesh.parts(s)[local]);
        finest_[s] = {std::max(finest_[s][0], parts_[i].level_u), std::max(finest_[s][1], parts_[i].level_v)};
    }
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (is_triangle(i)) {
            continue;
        }
        const std::uint32_t s = mesh.surface_of()[i];
        const bool back = mesh.is_back(i);
        if (!back) {
            by_cell_[{s, parts_[i].level_u, parts_[i].level_v, parts_[i].cell}] = i;
        }
        const Place at = place(i);
        for (std::size_t k = 0; k < 4; ++k) {
            const auto& [du, dv] = corner_steps[back ? 3 - k : k];
            const std::size_t corner = std::size_t{i} * 4 + k;
            const std::array<std::int64_t, 4> vertex{s, back ? 1 : 0, at.first[0] + du * at.width[0],
                                                     at.first[1] + dv * at.width[1]};
            corners_at_.try_emplace(vertex, std::array{corner, corner}).first->second[1] = corner;
        }
    }
}

bool PatchSplits::is_triangle(std::uint32_t patch) const {
    return mesh_.surfaces()[mesh_.surface_of()[patch]].vertex_count == 3;
}

PatchSplits::Place PatchSplits::place(std::uint32_t patch) const {
    const std::uint32_t s = mesh_.surface_of()[patch];
    const std::int64_t columns = std::int64_t{mesh_.grid(s).u} << part(patch).level_u;
    const std::int64_t width_u = std::int64_t{1} << (finest_[s][0] - part(patch).level_u);
    const std::int64_t width_v = std::int64_t{1} << (finest_[s][1] - part(patch).level_v);
    return {{part(patch).cell % columns * width_u, part(patch).cell / columns * width_v}, {width_u, width_v}};
}

/// Magnitude of the coefficient of x² along u (way 0) or v (1), where x goes from -1/2 to 1/2 within the
/// patch, from the values one patch's width beside it. The two sides are taken apart: beside the edge of a
/// shadow they bend against each other. A side on which something stands says nothing.
std::optional<double> PatchSplits::bend_along(std::uint32_t patch, std::size_t way,
                                              std::span<const float> corners, std::uint32_t channels,
                                              std::uint32_t channel) const {
    const std::int64_t s = mesh_.surface_of()[patch];
    const std::int64_t side = mesh_.is_back(patch) ? 1 : 0;
    const Place own = place(patch);
    const std::size_t across = 1 - way;
    struct Line {
        double mean = 0.0;
        bool even = true; ///< whether the patches on both of its sides show the same
    };
    // Over both ends of a line across the way, `steps` widths from the patch's first.
    const auto line = [&](std::int64_t steps) -> std::optional<Line> {
        Line result;
        for (const std::int64_t end : {0, 1}) {
            std::array<std::int64_t, 2> at = own.first;
            at[way] += steps * own.width[way];
            at[across] += end * own.width[across];
            const auto found = corners_at_.find({s, side, at[0], at[1]});
            if (found == corners_at_.end()) {
                return std::nullopt;
            }
            const auto a = static_cast<double>(corners[found->second[0] * channels + channel]);
            const auto b = static_cast<double>(corners[found->second[1] * channels + channel]);
            result.mean += 0.25 * (a + b);
            result.even = result.even && std::abs(a - b) <= same_light * std::max(std::abs(a), std::abs(b));
        }
        return result;
    };
    std::array<double, 2> ends{}; // what the patch itself shows at both
    for (std::size_t k = 0; k < 4; ++k) {
        ends[static_cast<std::size_t>(corner_steps[side == 1 ? 3 - k : k][way])] +=
            0.5 * static_cast<double>(corners[(std::size_t{patch} * 4 + k) * channels + channel]);
    }
    double sum = 0.0;
    int sides = 0;
    for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
        const auto beside = line(end == 0 ? -1 : 2);
        if (beside && beside->even && line(end == 0 ? 0 : 1).value().even) {
            sum += std::abs(beside->mean - 2.0 * ends[end] + ends[1 - end]) / 2.0;
            ++sides;
        }
    }
    return sides > 0 ? std::optional(sum / sides) : std::nullopt;
}

PatchSplit PatchSplits::across_bend(std::uint32_t patch, std::span<const float> corners,
                                    std::uint32_t channels, std::uint32_t channel, double bend) const {
    const PatchSplit by_shape = mesh_.split_by_shape(patch);
    if (is_triangle(patch)) {
        return by_shape;
    }
    std::optional<double> along_u = bend_along(patch, 0, corners, channels, channel);
    std::optional<double> along_v = bend_along(patch, 1, corners, channels, channel);
    if (!along_u && !along_v) {
        return by_shape;
    }
    // A bend is a sixth of both together, see square_error_of_bend.
    const auto left_of = [bend](double other) { return std::max(0.0, 6.0 * std::abs(bend) - other); };
    along_u = along_u ? along_u : left_of(*along_v);
    along_v = along_v ? along_v : left_of(*along_u);
    PatchSplit split{patch, *along_u >= least_share * *along_v, *along_v >= least_share * *along_u};
    if (split.along_u != split.along_v && halves_are_slender(patch, split.along_u ? 0 : 1)) {
        split.along_u = split.along_v = true;
    }
    return split;
}

/// Whether half of a patch on a way would be too slender.
/// @param way  0: half as wide along u; 1: along v
bool PatchSplits::halves_are_slender(std::uint32_t patch, std::size_t way) const {
    const PatchCorners own = mesh_.corners(patch);
    const auto& p = own.points;
    const std::array<double, 2> lengths{glm::distance(p[0], p[1]) + glm::distance(p[3], p[2]),
                                        glm::distance(p[0], p[3]) + glm::distance(p[1], p[2])};
    return lengths[1 - way] > most_slender * lengths[way] / 2.0;
}

/// Patches of the surface along the edges across a way that are wider than the patch on the other way, where
/// both meet: those that stay two steps behind if the patch is cut on that way.
/// @param way  0: that are wider along u; 1: along v
std::vector<std::uint32_t> PatchSplits::larger_beside(std::uint32_t patch, std::size_t way) const {
    std::vector<std::uint32_t> found;
    const std::uint32_t s = mesh_.surface_of()[patch];
    const Grid grid = mesh_.grid(s);
    const std::size_t across = 1 - way;
    const Place own = place(patch);
    const std::array<std::uint32_t, 2> levels{part(patch).level_u, part(patch).level_v};
    const std::array<std::int64_t, 2> fine{std::int64_t{grid.u} << finest_[s][0],
                                           std::int64_t{grid.v} << finest_[s][1]};
    for (const std::int64_t beside : {own.first[across] - 1, own.first[across] + own.width[across]}) {
        if (beside < 0 || beside >= fine[across]) {
            continue;
        }
        std::array<std::int64_t, 2> at = own.first;
        at[across] = beside;
        for (std::uint32_t level = 0; level < levels[way]; ++level) {
            for (std::uint32_t other = 0; other <= finest_[s][across]; ++other) {
                std::array<std::uint32_t, 2> of{};
                of[way] = level;
                of[across] = other;
                const std::int64_t u = at[0] >> (finest_[s][0] - of[0]);
                const std::int64_t v = at[1] >> (finest_[s][1] - of[1]);
                const auto cell = static_cast<std::uint32_t>(v * (std::int64_t{grid.u} << of[0]) + u);
                if (const auto entry = by_cell_.find({s, of[0], of[1], cell}); entry != by_cell_.end()) {
                    found.push_back(entry->second);
                }
            }
        }
    }
    return found;
}

void PatchSplits::grade(std::vector<PatchSplit>& splits) const {
    std::map<std::uint32_t, PatchSplit> chosen;
    std::vector<std::pair<std::uint32_t, std::size_t>> queue; // patches, and on which way they are cut
    const auto add = [&](std::uint32_t patch, std::size_t way) {
        const auto [entry, is_new] = chosen.try_emplace(patch, PatchSplit{patch, false, false});
        bool& cut = way == 0 ? entry->second.along_u : entry->second.along_v;
        if (!std::exchange(cut, true)) {
            queue.emplace_back(patch, way);
        }
    };
    for (const PatchSplit& split : splits) {
        for (const std::size_t way : {std::size_t{0}, std::size_t{1}}) {
            if (way == 0 ? split.along_u : split.along_v) {
                add(split.patch, way);
            }
        }
    }
    while (!queue.empty()) {
        const auto [patch, way] = queue.back();
        queue.pop_back();
        if (!is_triangle(patch)) {
            for (const std::uint32_t larger : larger_beside(patch, way)) {
                add(larger, way);
                if (halves_are_slender(larger, way)) {
                    add(larger, 1 - way);
                }
            }
        }
    }
    splits.clear();
    for (const auto& [patch, split] : chosen) {
        splits.push_back(split);
    }
}

} // namespace hemi
