#pragma once

#include "hemi/pipeline/form_factors.hpp"
#include "hemi/solver/solver.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// How much light that arrives at a patch counts for the light that arrives at a group: one unit of
/// irradiance at patch j brings w(j) of irradiance, times area, to the group.
///
/// The adjoint of the radiosity equation: w = h + rho F w with h = 1 on the group, that is the radiosity of a
/// scene in which the group alone glows. What a radiosity field that is wrong by a source r adds to the
/// group's irradiance is the sum of A r (F w).
/// Memory: 8 bytes a patch, group and channel.
class GroupImportance {
public:
    /// More groups than this are too many solutions.
    static constexpr std::uint32_t most_groups = 64;

    /// No group.
    GroupImportance() = default;
    /// @param factors      N known rows, or those of patches that reflect
    /// @param reflectance  N·channels
    /// @param channels     to solve for
    /// @param progress     gets the groups that are done, at every iteration
    /// @throws Cancelled by `progress`; NotConverged
    GroupImportance(const FormFactors& factors, std::span<const double> reflectance, std::uint32_t channels,
                    const Progress& progress);

    /// About what it takes to make one.
    [[nodiscard]] static std::uint64_t memory_bytes(std::uint64_t patches, std::uint64_t groups,
                                                    std::uint64_t channels);

    [[nodiscard]] std::uint32_t groups() const noexcept { return groups_; }
    /// Of a patch for all groups: channel c of group g at [g·channels + c].
    [[nodiscard]] std::span<const double> of(std::uint32_t patch) const {
        const std::size_t columns = std::size_t{groups_} * channels_;
        return std::span(values_).subspan(patch * columns, columns);
    }

private:
    std::uint32_t groups_ = 0;
    std::uint32_t channels_ = 1;
    std::vector<double> values_;
};

} // namespace hemi
