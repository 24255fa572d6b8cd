#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

/// Whether a scene is closed, as far as its rows and its own word say.
struct EnclosureFinding {
    bool closed = false;   ///< declared so, or (automatic) no row leaks
    bool declared = false; ///< the scene says that it is closed
    /// Rows of a scene declared closed whose e_i is above the limit, worst first.
    std::vector<std::uint32_t> leaks;
};
/// Looks for leaks.
/// @param factors        matrix and enclosure are read
/// @param max_row_error  e_i up to which a row does not leak
[[nodiscard]] EnclosureFinding find_leaks(const FormFactors& factors, double max_row_error);

/// A patch and the share that is wrong with it.
struct PatchFinding {
    std::uint32_t patch = 0;          ///< its index
    double share = 0.0;               ///< see Diagnosis
    std::optional<Vec3> towards = {}; ///< of the first Diagnosis::shown leaks: the direction in which it goes
};

/// Surfaces (of a stored file: whole groups) whose front no patch sees, while other patches meet enough back
/// faces to have met theirs.
struct ReversedGroup {
    std::uint32_t group = 0;    ///< its index
    std::uint32_t surfaces = 0; ///< 0: not known, from a stored file
    std::uint32_t patches = 0;  ///< of these surfaces
};

/// Verdict on the enclosure.
enum class EnclosureVerdict {
    closed,        ///< declared so, or no row leaks
    nearly_closed, ///< not declared; fewer than 5 % of the rows leak, or less than 0.1 % is lost
    open,          ///< declared so, or much is lost
};

/// Words of EnclosureVerdict.
template <>
struct Names<EnclosureVerdict> {
    /// Every value with its word.
    static constexpr NamedValue<EnclosureVerdict> table[] = {
        {EnclosureVerdict::closed, "closed"},
        {EnclosureVerdict::nearly_closed, "nearly closed"},
        {EnclosureVerdict::open, "open"}};
};

/// What is wrong with form factors, or with the geometry that they are of.
struct Diagnosis {
    /// Of a kind of finding so many are looked at more closely.
    static constexpr std::size_t shown = 10;

    RowSums sums;            ///< row sums and balance
    Reciprocity reciprocity; ///< of all pairs; where far patches stand in clusters, of none
    bool all_known = false;  ///< whether every row was computed
    bool declared = false;   ///< the enclosure was declared, closed or open
    EnclosureVerdict enclosure = EnclosureVerdict::open; ///< verdict
    double largest_factor = 0.0;                         ///< of all F(i, j)
    std::uint64_t outside_bounds = 0;                    ///< entries above 1, or rows whose sum is
    std::vector<PatchFinding> leaks;  ///< closed: e_i above the limit; nearly closed: e_i > 0; worst first
    std::vector<PatchFinding> buried; ///< b_i > buried_above: the centre lies under or inside something
    std::vector<PatchFinding> back_faces; ///< not buried, b_i above the limit, worst first
    std::vector<PatchFinding>
        partly_buried; ///< not buried, b_i above the limit, and a surface stands on them
    /// Patches on the outside of what at least nine tenths of the area enclose: they see the environment, and
    /// of patches none but one another. What they meet is not judged: no light of the rest comes there. Share
    /// is e_i.
    std::vector<PatchFinding> outside;
    std::vector<PatchFinding> close;         ///< a surface is close above: share is the gap in patch sizes
    std::vector<PatchFinding> never_visible; ///< no patch sees them, though they are not buried
    std::vector<ReversedGroup> reversed;     ///< normals point the wrong way
    std::vector<std::uint32_t> turned;       ///< patches of these surfaces, ascending
    std::vector<std::string> failures;       ///< what is out of tolerance, a clause each; empty: nothing
};
/// Looks for what is wrong with prepared form factors.
/// @param factors        prepared, see prepare_form_factors()
/// @param mesh           the patches, or null where the geometry is not known
/// @param max_row_error  tolerance for e_i in closed scenes, b_i of patches that are not buried, and row
/// balance
[[nodiscard]] Diagnosis diagnose(const FormFactors& factors, const PatchMesh* mesh, double max_row_error);

} // namespace hemi
