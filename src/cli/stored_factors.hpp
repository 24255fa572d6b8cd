#pragma once

#include "hemi/io/factor_file.hpp"

#include <filesystem>
#include <span>

/// Form factors in files, by extension.
namespace hemi::cli {

/// Writes `.hff`, `.mtx`, `.csv`, `.npz`, or View3D's `.txt` (text) and `.vf` (binary); "-" is `.csv` on
/// standard output.
/// @param emissivity  of every patch, for View3D's formats; empty where it is not known
void write_factors(const std::filesystem::path& path, const io::FactorFile& file,
                   std::span<const double> emissivity = {});

/// Whether the extension is one of View3D's factor files.
[[nodiscard]] bool is_view3d_factor_file(const std::filesystem::path& path);

/// Reads `.mtx`, `.csv` or `.npz`: F and nothing else.
/// @throws InvalidArgument for another extension; InputError.
[[nodiscard]] FormFactorMatrix read_bare_factors(const std::filesystem::path& path);

/// Whether the extension is one of those that read_bare_factors reads.
[[nodiscard]] bool is_bare_factor_file(const std::filesystem::path& path);

} // namespace hemi::cli
