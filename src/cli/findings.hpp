#pragma once

#include "hemi/io/factor_file.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// What `hemi check` finds in the rows.
namespace hemi::cli {

/// A patch and the share that is wrong with it.
struct PatchFinding {
    std::uint32_t patch = 0;
    double share = 0.0;
    std::optional<Vec3> towards = {}; ///< of the first findings_shown leaks: where it goes
};
/// Of a kind of finding so many are shown.
inline constexpr std::size_t findings_shown = 10;

/// Surfaces (of a stored file: whole groups) whose front no patch sees, while other patches meet enough back
/// faces to have met theirs.
struct TurnedGroup {
    std::uint32_t group = 0;
    std::uint32_t surfaces = 0; ///< 0: not known, from a stored file
    std::uint32_t patches = 0;
};

enum class EnclosureVerdict {
    closed,        ///< declared so, or no row leaks
    nearly_closed, ///< not declared; fewer than 5 % of the rows leak, or less than 0.1 % is lost
    open,
};

struct Findings {
    RowSums sums;
    Reciprocity reciprocity;
    bool all_known = false;
    bool declared = false; ///< the enclosure was declared, closed or open
    EnclosureVerdict enclosure = EnclosureVerdict::open;
    double largest_factor = 0.0;
    std::uint64_t outside_bounds = 0;    ///< entries above 1, or rows whose sum is
    std::vector<PatchFinding> leaks;     ///< closed: e_i above the limit; nearly closed: e_i > 0; worst first
    std::vector<PatchFinding> covered;   ///< b_i > buried_above: the centre lies under or inside something
    std::vector<PatchFinding> blocked;   ///< uncovered, b_i above the limit, worst first
    std::vector<PatchFinding> straddled; ///< uncovered, b_i above the limit, and a surface stands on them
    std::vector<PatchFinding> near;      ///< a surface hovers close above: share is the gap in patch sizes
    std::vector<PatchFinding> unseen;    ///< no patch sees them, though they are not covered
    std::vector<TurnedGroup> turned;
    std::vector<std::string> failures; ///< what is out of tolerance; empty: nothing
};

/// @param mesh  the patches, where the geometry is known
[[nodiscard]] Findings find_defects(const io::FactorFile& file, const PatchMesh* mesh, double max_row_error);

} // namespace hemi::cli
