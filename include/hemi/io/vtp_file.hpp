#pragma once

#include "hemi/io/result_file.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Numbers of every patch, under a name.
struct CellArray {
    std::string name;                    ///< as ParaView shows it
    std::vector<double> values;          ///< component c of patch i at [i·components + c]
    std::vector<std::string> components; ///< their names; empty: one number a patch
};

/// ParaView's XML PolyData (.vtp): every patch a polygon with corners of its own, in the patches' order,
/// front counter-clockwise. Cell data are `patch` (index), `group` (index into the field data `groups`, the
/// names), `area` and `arrays`. 64-bit numbers, raw behind the XML.
/// @throws InvalidArgument for arrays of another length, values that are infinite; IoError
void write_vtp(const std::filesystem::path& path, const PatchMesh& mesh, std::span<const CellArray> arrays);

/// Points as PolyData (.vtp), each a vertex; point data are `normals`, where there are any, and `arrays`.
/// @param path       of the file
/// @param positions  P
/// @param normals    P, or none
/// @param arrays     values of points in place of patches
/// @throws InvalidArgument for arrays of another length, values that are infinite; IoError
void write_points_vtp(const std::filesystem::path& path, std::span<const Vec3> positions,
                      std::span<const Vec3> normals, std::span<const CellArray> arrays);

/// The same as write_vtp() as a table: one line a patch with index,group,area,cx,cy,cz,nx,ny,nz (index from
/// 0; shortest digits that read back equal), then a column for every component of the arrays, `name` or
/// `name_component`. Cells of values that are not a number are empty.
/// @param path    of the file
/// @param mesh    N patches
/// @param arrays  columns
/// @param left    what is left of the patches
/// @throws InvalidArgument for arrays and places of another length; IoError
void write_patch_table(const std::filesystem::path& path, const PatchMesh& mesh,
                       std::span<const CellArray> arrays, const PatchPlaces& left = {});

/// What a stored solution knows of its patches, by the words of Quantity ("_" for "-"): row balance,
/// radiosity, irradiance, direct, exitance, reflectance, emissivity, and estimated errors where there are
/// any; but "row_error" is the estimated error of the row. Of heat temperature and net_flux, too, not a
/// number where they are not known.
/// @param result  what is shown
/// @param mesh    its patches
[[nodiscard]] std::vector<CellArray> solution_arrays(const ResultFile& result, const PatchMesh& mesh);
/// What is known of patches' parts, of the patches: means by area over parts of which it is known, of
/// "temperature" that of the fourth power; not a number of those of which nothing is left.
/// @param arrays  of the parts
/// @param parts   of the patches
/// @param areas   of the parts
/// @throws InvalidArgument as means_of_patches()
[[nodiscard]] std::vector<CellArray> means_of_cells(std::vector<CellArray> arrays, const PatchParts& parts,
                                                    std::span<const double> areas);
/// What form factors know of single patches (of parts also which they are of, as "patch_of"): row balance,
/// and the estimated error of rows where there is one.
[[nodiscard]] std::vector<CellArray> factor_arrays(const FormFactors& factors);
/// Row i of F, zeros included, as the array "F_i": of patch i, where rows are those of parts, as a mean over
/// its parts by area.
/// @throws InvalidArgument for a row that is not there or was not computed
[[nodiscard]] CellArray row_array(const FormFactors& factors, std::uint32_t patch);

} // namespace hemi::io
