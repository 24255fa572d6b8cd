#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Form factors with all that is needed to use them again: what a `.hff` file holds.
struct FactorFile {
    FormFactorMatrix factors{0};         ///< N rows
    std::vector<double> areas;           ///< N
    std::vector<std::string> groups;     ///< names
    std::vector<std::uint32_t> group_of; ///< N, index into groups
    std::vector<std::uint32_t> contacts; ///< ascending: patches that see nothing, face to face with a surface
    std::uint64_t geometry_hash = 0;     ///< PatchMesh::geometry_hash of what the rows belong to
    std::string preset = "plain";        ///< of the settings, as `hemi --preset`
    std::string method = "hemicube";     ///< how the rows were found, as `hemi --method`
    std::uint32_t resolution = 0;        ///< texels along a hemicube edge; 0 where it does not apply
    std::uint32_t eye_points = 1;        ///< sample points a patch
    std::uint32_t shadow_rays = 0;       ///< for each pair that is partly hidden
    std::uint64_t seed = 0;              ///< of the hemicubes' rotations
    std::string renderer;                ///< what computed the rows
    std::string enclosure = "auto";      ///< auto, closed or open, as the scene said
    /// Better rows of a few patches, by which the rows are judged, whatever is done to them; no row is known
    /// where none were computed. See compute_reference().
    FormFactorMatrix reference{0};
    std::optional<FactorErrorEstimate> error; ///< of the rows as they are here
    std::string chosen_for; ///< why the settings are what they are, where the program chose them
};

/// Writes `.hff`: a chunk file, whose rows are independent, checksummed blocks with
/// their own 64-bit offsets, row balance and, where it is known, visibility. Raw rows, complete under the
/// final name or not there at all.
/// @throws InvalidArgument if areas, groups, reference or error do not fit the rows; IoError
void write_hff(const std::filesystem::path& path, const FactorFile& file);
/// Reads `.hff`.
/// @throws InputError for anything that is not a sound `.hff`: every length, offset, index and checksum is
/// tested.
[[nodiscard]] FactorFile read_hff(const std::filesystem::path& path);

/// Matrix Market, `coordinate real general`, 1-based, entry (i, j) = F(i, j); 9 significant digits.
void write_mtx(const std::filesystem::path& path, const FormFactorMatrix& factors);
/// `i,j,F` triples with that header line, 0-based; 9 significant digits.
void write_csv(const std::filesystem::path& path, const FormFactorMatrix& factors);
/// What scipy.sparse.load_npz reads as a CSR matrix of float32.
void write_npz(const std::filesystem::path& path, const FormFactorMatrix& factors);
/// What numpy.load reads as an N x N array of float32, zeros included: 4 N² bytes.
/// @throws InvalidArgument for unknown rows; IoError
void write_npy(const std::filesystem::path& path, const FormFactorMatrix& factors);

/// The two kinds of View3D's view factor file.
enum class View3dFormat { text, binary };

/// A view factor file as View3D writes it: a header of 30 characters (program, version, format, enclosure,
/// 0 for factors without reflection, N), N areas, N rows of N factors, N emissivities. Text has 9 significant
/// digits; binary is 32-bit floats behind the header and a CR LF. Zeros are written too: N² numbers.
/// @param path        of the file
/// @param file        factors, areas and enclosure are written
/// @param format      text or binary
/// @param emissivity  N, limited to [0.001, 0.999] as View3D does; empty: 0.999
/// @throws InvalidArgument for unknown rows and spans that do not fit; IoError
void write_view3d(const std::filesystem::path& path, const FactorFile& file, View3dFormat format,
                  std::span<const double> emissivity = {});

/// EnergyPlus' ZoneProperty:UserViewFactors:BySurfaceName (.idf): a triple from, to, F for every pair of
/// groups, which are the surfaces. The zone has the name of the file; 9 significant digits.
/// @param path         of the file; its stem is the name of the zone
/// @param file         factors, areas and groups are written
/// @param diagnostics  warned of rows that do not sum to 1, which EnergyPlus changes
/// @throws InvalidArgument for unknown rows, areas or groups that do not fit, names that EnergyPlus has not
///   (with `,` `;` `!`, a line end or outer blanks, of more than 100 characters, equal but for their case);
///   IoError
void write_energyplus(const std::filesystem::path& path, const FactorFile& file, Diagnostics& diagnostics);

/// The two kinds of Elmer's ViewFactors.dat.
enum class ElmerFormat { text, binary };

/// Elmer's ViewFactors.dat, 1-based. Text: for every row a line with the number k of its entries and k lines
/// `i j F`, 9 significant digits. Binary: int32 N, for every row int32 k and k times int32 j, float64 F,
/// little endian. Patches must be Elmer's boundary elements in their order.
/// @throws InvalidArgument for unknown rows; IoError
void write_elmer(const std::filesystem::path& path, const FormFactorMatrix& factors, ElmerFormat format);

/// HDF5, chunked and compressed. /factors: data (float32), indices (uint32), indptr (int64) of the rows, with
/// attributes format ("csr") and shape. /patches, where areas are known: area, group (index into
/// /groups/name), row_sum, environment, blocked, known, and row_error where it is known. /groups: name.
/// Attributes say what made the rows and, as `units`, in what numbers are. The compressed file is put
/// together in memory.
/// @param path    of the file
/// @param file    is written as a whole, but for the reference rows
/// @param repair  what was made true of the rows, for the attribute: none, reciprocity, closure
/// @throws InvalidArgument if areas or groups do not fit the rows; IoError
void write_h5(const std::filesystem::path& path, const FactorFile& file, const std::string& repair);

/// Reads Matrix Market as write_mtx() writes it.
/// Row balance is in none of the files that know F alone: environment and blocked are 0.
/// @throws ParseError or InputError with file, place and value
[[nodiscard]] FormFactorMatrix read_mtx(const std::filesystem::path& path);
/// Reads triples as write_csv() writes them. The file does not say the size: it is one more than the largest
/// index.
/// @throws ParseError or InputError with file, place and value
[[nodiscard]] FormFactorMatrix read_csv(const std::filesystem::path& path);
/// Reads what scipy.sparse.save_npz writes of a CSR matrix.
/// @throws ParseError or InputError with file, place and value
[[nodiscard]] FormFactorMatrix read_npz(const std::filesystem::path& path);
/// Reads Elmer's ViewFactors.dat. Text does not say the size: it is the number of rows.
/// @throws ParseError or InputError with file, place and value
[[nodiscard]] FormFactorMatrix read_elmer(const std::filesystem::path& path, ElmerFormat format);
/// Reads a view factor file of View3D: factors, areas and enclosure, nothing else.
/// @throws ParseError or InputError with file, place and value; also for factors that include reflection
[[nodiscard]] FactorFile read_view3d(const std::filesystem::path& path, View3dFormat format);

} // namespace hemi::io
