#pragma once

#include "hemi/io/factor_file.hpp"

#include <filesystem>

/// Form factors in files, by extension.
namespace hemi::cli {

/// Writes `.hff`, `.mtx`, `.csv` or `.npz`; "-" is `.csv` on standard output.
void write_factors(const std::filesystem::path& path, const io::FactorFile& file);

/// Reads `.mtx`, `.csv` or `.npz`: F and nothing else.
/// @throws InvalidArgument for another extension; InputError.
[[nodiscard]] FormFactorMatrix read_bare_factors(const std::filesystem::path& path);

/// Whether the extension is one of those that read_bare_factors reads.
[[nodiscard]] bool is_bare_factor_file(const std::filesystem::path& path);

} // namespace hemi::cli
