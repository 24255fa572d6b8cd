#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/matrix/repair.hpp"

#include <filesystem>
#include <optional>
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

/// What a file knows: of each, all of those before.
enum class FactorContent { factors, areas, all };

/// A format that holds form factors without the patches' geometry.
struct FactorFormat {
    std::string_view extension;
    FactorContent needs;    ///< what it cannot be written without
    std::string_view holds; ///< what that is, for messages
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

/// Reads a file of form factors by its extension.
/// @throws InvalidArgument for an extension that is not read; InputError.
[[nodiscard]] io::FactorFile read_factors(const std::filesystem::path& path);

/// What a file of that extension knows, if it is read: all of it a `.hff`, areas View3D's, F alone the
/// others.
[[nodiscard]] std::optional<FactorContent> factor_content(const std::filesystem::path& path);

/// Whether it is a file that read_factors reads, but no `.hff`.
[[nodiscard]] bool is_foreign_factor_file(const std::filesystem::path& path);

} // namespace hemi::cli
