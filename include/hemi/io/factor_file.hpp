#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/core/patch_cuts.hpp"
#include "hemi/matrix/form_factors.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// Writes `.hff`: a chunk file, whose rows are independent, checksummed blocks with
/// their own 64-bit offsets, row balance and, where it is known, visibility. Raw rows, complete under the
/// final name or not there at all.
/// @throws InvalidArgument if areas, groups, reference or error do not fit the rows; IoError
void write_hff(const std::filesystem::path& path, const FormFactors& file);
/// Reads `.hff`.
/// @throws InputError for anything that is not a sound `.hff`: every length, offset, index and checksum is
/// tested.
[[nodiscard]] FormFactors read_hff(const std::filesystem::path& path);

/// Which patches the rows of a `.hff` are of.
struct RowsGeometry {
    std::uint32_t patches = 0;       ///< number of rows
    std::uint64_t geometry_hash = 0; ///< PatchMesh::geometry_hash
    PatchCuts cuts;                  ///< as FormFactors::cuts
};
/// Reads the beginning of a `.hff`, without any row.
/// @throws InputError
[[nodiscard]] RowsGeometry read_hff_geometry(const std::filesystem::path& path);

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
void write_view3d(const std::filesystem::path& path, const FormFactors& file, View3dFormat format,
                  std::span<const double> emissivity = {});

/// EnergyPlus' ZoneProperty:UserViewFactors:BySurfaceName (.idf): a triple from, to, F for every pair of
/// groups, which are the surfaces; 9 significant digits.
/// @param path         of the file
/// @param file         factors, areas and groups are written
/// @param diagnostics  warned of rows that do not sum to 1, which EnergyPlus changes
/// @param zone         the zone's name; empty: the stem of the file's
/// @throws InvalidArgument for unknown rows, areas or groups that do not fit, names that EnergyPlus has not
///   (with `,` `;` `!`, a line end or outer blanks, of more than 100 characters, equal but for their case);
///   IoError
void write_energyplus(const std::filesystem::path& path, const FormFactors& file, Diagnostics& diagnostics,
                      const std::string& zone = {});

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
/// @param path  of the file
/// @param file  is written as a whole, but for the reference rows
/// @throws InvalidArgument if areas or groups do not fit the rows; IoError
void write_h5(const std::filesystem::path& path, const FormFactors& file);

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
[[nodiscard]] FormFactors read_view3d(const std::filesystem::path& path, View3dFormat format);

/// What a file of form factors holds: of each, all of those before.
enum class FactorContent {
    factors, ///< F alone
    areas,   ///< areas as well
    all,     ///< group names, row balance and what made the rows as well
};

/// What write_factors() knows beside the form factors.
struct FactorContext {
    std::span<const double> emissivity = {}; ///< of every patch; empty where it is not known
    std::string zone = {}; ///< EnergyPlus' name of what the surfaces close in; empty: the file's name
};

/// A format of files that hold form factors without the patches' geometry.
struct FactorFormat {
    std::string_view extension; ///< ".hff"
    FactorContent needs;        ///< what it cannot be written without
    std::string_view holds;     ///< what that is, for messages
    std::string_view lost;      ///< what of a `.hff` it does not hold
    /// Writes it.
    void (*write)(const std::filesystem::path&, const FormFactors&, const FactorContext&, Diagnostics&);
};

/// Extensions of all formats that write_factors() writes.
[[nodiscard]] std::vector<std::string_view> factor_extensions();
/// The format of a path with one of these extensions; "-" is `.csv` on standard output.
/// @throws InvalidArgument for another extension
[[nodiscard]] const FactorFormat& factor_format(const std::filesystem::path& path);
/// Writes form factors in the format of the path's extension.
/// @throws InvalidArgument for an extension that is not written and what the format cannot hold; IoError
void write_factors(const std::filesystem::path& path, const FormFactors& factors,
                   const FactorContext& context, Diagnostics& diagnostics);
/// Reads a file of form factors by its extension.
/// @throws InvalidArgument for an extension that is not read; InputError
[[nodiscard]] FormFactors read_factors(const std::filesystem::path& path);
/// What a file of that extension holds, if it is read: all of it a `.hff`, areas View3D's, F alone the
/// others.
[[nodiscard]] std::optional<FactorContent> factor_content(const std::filesystem::path& path);

/// F summed over groups as CSV: group, area, a column for every group, environment, blocked; a line for each
/// leaving group.
/// @param path    of the file
/// @param names   of the groups
/// @param groups  what is written
void write_group_factors_csv(const std::filesystem::path& path, std::span<const std::string> names,
                             const GroupFactors& groups);

} // namespace hemi::io
