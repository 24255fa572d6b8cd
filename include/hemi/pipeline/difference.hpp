#pragma once

#include "hemi/display/false_colours.hpp"
#include "hemi/pipeline/quantities.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hemi {

/// A solution and what it is of, for compare_solutions().
struct SolutionOf {
    const Scene& scene;       ///< channels, materials, names of groups
    const PatchMesh& mesh;    ///< its patches
    const Solution& solution; ///< with its exitance
};

/// How patches of two solutions were brought together.
enum class Pairing {
    same_patches, ///< both are of the same patches
    nearest,      ///< every patch of the first with one of the second that is there, or near
};

/// Words of Pairing.
template <>
struct Names<Pairing> {
    /// Every value with its word.
    static constexpr NamedValue<Pairing> table[] = {{Pairing::same_patches, "same-patches"},
                                                    {Pairing::nearest, "nearest"}};
};

/// Which patch of a second mesh belongs to each of a first one.
struct PatchPairs {
    Pairing pairing = Pairing::same_patches; ///< how patches were paired
    std::uint32_t off = 0;                   ///< patches of the first that lie on none of the second
    double farthest = 0.0;                   ///< of these, the largest distance between centres, scene units
    std::vector<std::uint32_t> partner;      ///< patch of the second, N
};
/// Pairs the patches of two solutions, see compare_solutions().
/// @param first   N patches
/// @param second  where partners are looked for
/// @throws InvalidArgument where no patch of the second looks the way of one of the first
[[nodiscard]] PatchPairs pair_patches(const PatchMesh& first, const PatchMesh& second);

/// A quantity of a group in two solutions, over its patches that have a value in both. Means are by area; not
/// a number where no patch has.
struct GroupDifference {
    double area = 0.0;       ///< of these patches, scene units squared
    double first = 0.0;      ///< mean of the first
    double second = 0.0;     ///< mean of the second
    double difference = 0.0; ///< mean of second - first
    double rms = 0.0;        ///< of second - first
    double largest = 0.0;    ///< second - first where its magnitude is largest
};

/// Two solutions, patch by patch of the first.
struct SolutionDifference : PatchPairs {
    FalseColours first;             ///< the quantity of the first, N
    std::vector<double> second;     ///< of the second, at the patches of the first, N
    std::vector<double> difference; ///< second - first, N; not a number where either is
    double largest_lit = 0.0;       ///< largest magnitude of these on patches of the first that do not shine
    std::vector<GroupDifference> groups; ///< of every group of the first; a last one of all patches
};

/// Compares a quantity of two solutions. Where they are not of the same patches, every patch of the first is
/// paired with that of the second on which its centre lies and that looks the same way; else with the one
/// with the nearest centre of those that look its way, within 60 degrees.
/// @param first     counts as the reference: differences are second - first
/// @param second    may be of another scene
/// @param quantity  that both have
/// @param channel   as in patch_quantity(), of both
/// @throws InvalidArgument as patch_quantity(), naming which; where units differ; where no patch of the
/// second
///   looks the way of one of the first
[[nodiscard]] SolutionDifference compare_solutions(const SolutionOf& first, const SolutionOf& second,
                                                   Quantity quantity, const std::string& channel = "mean");
/// The same with patches that were paired before.
/// @param first     counts as the reference
/// @param second    may be of another scene
/// @param pairs     of their meshes
/// @param quantity  that both have
/// @param channel   as in patch_quantity(), of both
/// @throws InvalidArgument as patch_quantity(), naming which; where units differ
[[nodiscard]] SolutionDifference compare_solutions(const SolutionOf& first, const SolutionOf& second,
                                                   PatchPairs pairs, Quantity quantity,
                                                   const std::string& channel);

/// The difference in false colours: of the cool-warm map, zero in its middle, by a scale for patches that do
/// not shine by themselves, where there are such.
[[nodiscard]] FalseColours difference_colours(const SolutionDifference& difference);

} // namespace hemi
