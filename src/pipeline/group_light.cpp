#include "hemi/pipeline/group_light.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace hemi {

namespace {

/// What arrives at a patch in a channel, per area.
double irradiance_at(std::size_t at, const PatchValues& values, const Solution& solution) {
    if (!solution.irradiance.empty()) {
        return solution.irradiance[at];
    }
    const double reflectance = values.reflectance[at];
    return reflectance > 0.0 ? (solution.radiosity[at] - solution.exitance[at]) / reflectance
                             : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

std::vector<GroupLight> group_light(const PatchMesh& mesh, const PatchValues& values,
                                    const Solution& solution, std::span<const double> weights) {
    const std::size_t channels = solution.channels;
    const std::size_t count = mesh.size() * channels;
    if (values.channels != channels || values.reflectance.size() != count ||
        solution.radiosity.size() != count || solution.exitance.size() != count ||
        (!solution.irradiance.empty() && solution.irradiance.size() != count) ||
        (!weights.empty() && weights.size() != channels)) {
        throw InvalidArgument(fmt::format("light of groups: {} radiosities for {} patches of {} channels",
                                          solution.radiosity.size(), mesh.size(), channels));
    }
    std::vector<GroupLight> groups(mesh.groups().size() + 1);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        double exitance = 0.0;
        double irradiance = 0.0;
        double radiosity = 0.0;
        for (std::size_t c = 0; c < channels; ++c) {
            const double weight = weights.empty() ? 1.0 : weights[c];
            const std::size_t at = i * channels + c;
            if (weight == 0.0) { // what does not count may be unknown
                continue;
            }
            exitance += weight * solution.exitance[at];
            irradiance += weight * irradiance_at(at, values, solution);
            radiosity += weight * solution.radiosity[at];
        }
        const double area = mesh.areas()[i];
        for (GroupLight* group : {&groups[mesh.group(i)], &groups.back()}) {
            group->least = group->area > 0.0 ? std::min(group->least, radiosity) : radiosity;
            group->most = group->area > 0.0 ? std::max(group->most, radiosity) : radiosity;
            group->area += area;
            group->exitance += area * exitance; // sums, until all patches are in them
            group->received += area * irradiance;
            group->leaving += area * radiosity;
        }
    }
    for (GroupLight& group : groups) {
        if (group.area > 0.0) {
            group.exitance /= group.area;
            group.irradiance = group.received / group.area;
            group.radiosity = group.leaving / group.area;
        } else {
            group.exitance = group.irradiance = group.radiosity = group.least = group.most =
                std::numeric_limits<double>::quiet_NaN();
        }
    }
    return groups;
}

} // namespace hemi
