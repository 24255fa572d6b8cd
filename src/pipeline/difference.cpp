#include "hemi/pipeline/difference.hpp"

#include "hemi/core/error.hpp"
#include "pipeline/patch_locator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace hemi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

FalseColours quantity_of(const char* which, const SolutionOf& of, Quantity quantity,
                         const std::string& channel) {
    try {
        return patch_quantity(quantity, of.scene, of.mesh, of.solution, channel);
    } catch (const InvalidArgument& error) {
        throw InvalidArgument(fmt::format("the {} solution: {}", which, error.what()));
    }
}

std::uint32_t nearest_patch(const PatchMesh& mesh, const Vec3& point, const Vec3& normal) {
    constexpr double least_cosine = 0.5;
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const double way = glm::distance(mesh.centres()[i], point);
        if (way < least && glm::dot(mesh.normal(i), normal) >= least_cosine) {
            least = way;
            found = i;
        }
    }
    if (!std::isfinite(least)) {
        throw InvalidArgument(fmt::format(
            "no patch of the second solution looks the way of the one at {:.6g} {:.6g} {:.6g} of the first; "
            "are they of the same scene?",
            point.x, point.y, point.z));
    }
    return found;
}

/// Sums over patches, then what comes of them.
void add(GroupDifference& group, double area, double first, double second) {
    const double difference = second - first;
    group.area += area;
    group.first += area * first;
    group.second += area * second;
    group.difference += area * difference;
    group.rms += area * difference * difference;
    group.largest = std::abs(difference) > std::abs(group.largest) ? difference : group.largest;
}

void finish(GroupDifference& group) {
    if (!(group.area > 0.0)) {
        group = {0.0, none, none, none, none, none};
        return;
    }
    group.first /= group.area;
    group.second /= group.area;
    group.difference /= group.area;
    group.rms = std::sqrt(group.rms / group.area);
}

} // namespace

PatchPairs pair_patches(const PatchMesh& first, const PatchMesh& second) {
    PatchPairs pairs;
    pairs.partner.resize(first.size());
    if (first.size() == second.size() && first.geometry_hash() == second.geometry_hash()) {
        std::iota(pairs.partner.begin(), pairs.partner.end(), 0U);
        return pairs;
    }
    pairs.pairing = Pairing::nearest;
    const PatchLocator locator(second);
    for (std::uint32_t i = 0; i < first.size(); ++i) {
        const Vec3& centre = first.centres()[i];
        if (const auto there = locator.find({centre, first.normal(i)})) {
            pairs.partner[i] = *there;
            continue;
        }
        pairs.partner[i] = nearest_patch(second, centre, first.normal(i));
        pairs.farthest = std::max(pairs.farthest, glm::distance(second.centres()[pairs.partner[i]], centre));
        ++pairs.off;
    }
    return pairs;
}

SolutionDifference compare_solutions(const SolutionOf& first, const SolutionOf& second, Quantity quantity,
                                     const std::string& channel) {
    return compare_solutions(first, second, pair_patches(first.mesh, second.mesh), quantity, channel);
}

SolutionDifference compare_solutions(const SolutionOf& first, const SolutionOf& second, PatchPairs pairs,
                                     Quantity quantity, const std::string& channel) {
    SolutionDifference result;
    static_cast<PatchPairs&>(result) = std::move(pairs);
    result.first = quantity_of("first", first, quantity, channel);
    const FalseColours other = quantity_of("second", second, quantity, channel);
    if (result.first.unit != other.unit) {
        throw InvalidArgument(fmt::format("the first solution is in {}, the second in {}; these are not "
                                          "compared",
                                          result.first.unit, other.unit));
    }
    const std::size_t channels = first.scene.channels.size();
    const std::span<const double> exitance = first.solution.exitance;
    result.groups.resize(first.mesh.groups().size() + 1);
    for (std::uint32_t i = 0; i < first.mesh.size(); ++i) {
        const double value = result.first.values[i];
        result.second.push_back(other.values[result.partner[i]]);
        result.difference.push_back(result.second[i] - value);
        const auto own = exitance.subspan(i * channels, channels);
        if (std::isfinite(result.difference[i]) &&
            std::none_of(own.begin(), own.end(), [](double one) { return one > 0.0; })) {
            result.largest_lit = std::max(result.largest_lit, std::abs(result.difference[i]));
        }
        if (!std::isnan(result.difference[i])) {
            for (GroupDifference* group : {&result.groups[first.mesh.group(i)], &result.groups.back()}) {
                add(*group, first.mesh.areas()[i], value, result.second[i]);
            }
        }
    }
    std::for_each(result.groups.begin(), result.groups.end(), finish);
    return result;
}

FalseColours difference_colours(const SolutionDifference& difference) {
    FalseColours shown{difference.difference, fmt::format("Difference: {}", difference.first.title),
                       difference.first.unit};
    shown.map = ColourMap::cool_warm;
    shown.across_materials = difference.first.across_materials;
    if (difference.largest_lit > 0.0) {
        shown.range = {-difference.largest_lit, difference.largest_lit};
    }
    return shown;
}

} // namespace hemi
