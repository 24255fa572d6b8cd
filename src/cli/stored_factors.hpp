#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/matrix/repair.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Form factors in files, by extension.
namespace hemi::cli {

/// What write_factors knows beside the rows.
struct FactorContext {
    std::span<const double> emissivity = {}; ///< of every patch; empty where it is not known
    Repair repair = Repair::none;            ///< what was done to the rows
};

/// A format that holds form factors without the patches' geometry.
struct FactorFormat {
    std::string_view extension;
    /// What of a .hff it needs that other files do not have; empty: nothing but F.
    std::string_view needs;
    /// What of a .hff it does not hold.
    std::string_view lost;
    void (*write)(const std::filesystem::path&, const io::FactorFile&, const FactorContext&, Diagnostics&);
};

/// Extensions of all formats that write_factors writes.
[[nodiscard]] std::vector<std::string_view> factor_extensions();

/// The format of a path with one of these extensions; "-" is `.csv` on standard output.
[[nodiscard]] const FactorFormat& factor_format(const std::filesystem::path& path);

/// Writes form factors in the format of the path.
void write_factors(const std::filesystem::path& path, const io::FactorFile& file,
                   const FactorContext& context, Diagnostics& diagnostics);

/// Reads `.mtx`, `.csv` or `.npz`: F and nothing else.
/// @throws InvalidArgument for another extension; InputError.
[[nodiscard]] FormFactorMatrix read_bare_factors(const std::filesystem::path& path);

/// Whether the extension is one of those that read_bare_factors reads.
[[nodiscard]] bool is_bare_factor_file(const std::filesystem::path& path);

} // namespace hemi::cli
