#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/core/patch_cuts.hpp"
#include "hemi/core/patch_parts.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/provenance.hpp"
#include "hemi/matrix/repair.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

/// What it took to compute rows in this process; not stored in files.
struct RowWork {
    std::size_t rows = 0;           ///< computed now; those from a file or a checkpoint do not count
    std::uint64_t hemicubes = 0;    ///< drawn for them; 0 by another method
    double seconds = 0.0;           ///< in which these hemicubes were drawn
    double reference_seconds = 0.0; ///< spent on reference rows
    bool from_file = false;         ///< rows were read
};

/// Form factors of a scene with all that is needed to use them again: what a `.hff` file holds.
///
/// Raw, as computed and stored, until prepare_form_factors() has marked buried patches, enforced what Repair
/// asks for and estimated the error; `repair` then says what was done.
struct FormFactors {
    FormFactorMatrix matrix{0};          ///< F, N rows
    std::vector<double> areas;           ///< N, scene units squared
    std::vector<std::string> groups;     ///< names
    std::vector<std::uint32_t> group_of; ///< N, index into groups
    /// Ascending: patches that see nothing and lie face to face against another surface, see
    /// find_touching_faces().
    std::vector<std::uint32_t> touching;
    /// Where rows are those of parts: which patches these are parts of. See merge_parts().
    PatchParts parts;
    /// How the patches of rows that a refinement came to were cut, see solve_refined(); else nothing.
    PatchCuts cuts;
    std::uint64_t geometry_hash = 0;            ///< PatchMesh::geometry_hash of what the rows belong to
    Enclosure enclosure = Enclosure::automatic; ///< as the scene said
    Provenance provenance;                      ///< what made the rows
    /// Better rows of a few patches, by which the rows are judged, whatever is done to them; no row is known
    /// where none were computed. See compute_reference().
    FormFactorMatrix reference{0};
    std::optional<FactorErrorEstimate> error; ///< estimated, of the rows as they are here
    std::optional<RepairReport> repair;       ///< what was done to the rows; none: they are raw
    RowWork work;                             ///< what it took

    /// Number of patches that the rows are about: of those that they are parts of, or N.
    [[nodiscard]] std::uint32_t patches() const { return parts.any() ? parts.patches() : matrix.size(); }
};

/// Form factors of the patches that rows are parts of: sums over the parts where light arrives, means by area
/// where it leaves. Areas are those of the parts; a patch without any has area 0 and an empty row, all of
/// which meets backs. A row is known where those of all of its parts are.
/// @param factors  N rows of parts
/// @return rows of the patches, without visibility, reference and touching; `factors` where no parts are
/// @throws InvalidArgument if the parts do not fit the rows
[[nodiscard]] FormFactors merge_parts(FormFactors factors);

} // namespace hemi
