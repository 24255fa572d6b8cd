#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/core/patch_parts.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/provenance.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hemi::io {

/// Some rows of a scene as the engine made them, for merge_factor_parts() to make form factors of them and
/// all others: a `.hff` that is marked as a part, and that nothing else reads. It holds the patches' geometry
/// as well, since a pair's factor needs rows of two parts.
struct FactorPart {
    std::uint32_t first = 0; ///< of its rows
    std::uint32_t end = 0;   ///< one past the last
    std::uint32_t size = 0;  ///< N, rows of all parts
    /// What all parts of a scene have in common: names and values.
    std::map<std::string, std::string> key;
    bool visibility = false;                    ///< rows are rows of visibility (RawRow), or of F
    bool estimated = false;                     ///< there are better rows in the parts
    Enclosure enclosure = Enclosure::automatic; ///< as the scene said
    Provenance provenance;                      ///< what made the rows
    std::vector<std::string> groups;            ///< names
    std::vector<Surface> surfaces;              ///< with their grids; materials are not those of the scene
    PatchParts parts;                           ///< as FormFactors::parts
    std::uint64_t entries = 0;                  ///< of the rows: patches that are not wholly hidden
    FormFactorMatrix rows{0};                   ///< `first` to `end` - 1 are known
    /// Rows of visibility of those patches of the part that errors are estimated by; no row is known where
    /// none of them is.
    FormFactorMatrix reference{0};
};

/// Writes a part.
/// @param path  of the file
/// @param mesh  that the rows are of, none of whose patches is cut further; gives groups and surfaces
/// @param part  all but groups and surfaces
/// @throws InvalidArgument for a mesh of cut patches; IoError
void write_factor_part(const std::filesystem::path& path, const PatchMesh& mesh, const FactorPart& part);

/// How much of a part is read.
enum class FactorPartContent {
    description, ///< no rows
    all,         ///< rows as well
};
/// Reads a part.
/// @throws InputError for anything that is no sound part
[[nodiscard]] FactorPart read_factor_part(const std::filesystem::path& path,
                                          FactorPartContent content = FactorPartContent::all);

/// @throws InputError if the file is a part, where all rows are wanted
void refuse_factor_part(const std::filesystem::path& path);

} // namespace hemi::io
