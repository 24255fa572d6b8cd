#include "cli/stored_factors.hpp"

#include "cli/outputs.hpp"
#include "cli/repair_rows.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace hemi::cli {

namespace {

using Path = std::filesystem::path;
using io::FactorFile;

constexpr std::string_view all_but_f =
    "areas, group names, row balance (environment, blocked), settings and the geometry's hash";
constexpr std::string_view all_but_areas =
    "group names, row balance (environment, blocked), settings and the geometry's hash";

constexpr FactorFormat formats[] = {
    {".hff", FactorContent::all, "areas, names, row balance and the geometry's hash", "",
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_hff(path, file);
     }},
    {".mtx", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_mtx(path, file.factors);
     }},
    {".csv", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_csv(path, file.factors);
     }},
    {".npz", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_npz(path, file.factors);
     }},
    {".npy", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_npy(path, file.factors);
     }},
    {".h5", FactorContent::factors, "", "visibilities and the better rows by which errors are estimated",
     [](const Path& path, const FactorFile& file, const FactorContext& context, Diagnostics&) {
         io::write_h5(path, file, repair_name(context.repair));
     }},
    {".txt", FactorContent::areas, "areas", all_but_areas,
     [](const Path& path, const FactorFile& file, const FactorContext& context, Diagnostics&) {
         io::write_view3d(path, file, io::View3dFormat::text, context.emissivity);
     }},
    {".vf", FactorContent::areas, "areas", all_but_areas,
     [](const Path& path, const FactorFile& file, const FactorContext& context, Diagnostics&) {
         io::write_view3d(path, file, io::View3dFormat::binary, context.emissivity);
     }},
    {".dat", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_elmer(path, file.factors, io::ElmerFormat::text);
     }},
    {".bin", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_elmer(path, file.factors, io::ElmerFormat::binary);
     }},
    {".idf", FactorContent::all, "areas and group names",
     "factors of single patches (groups' are there), areas, row balance (environment, blocked), settings and "
     "the geometry's hash",
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics& diagnostics) {
         io::write_energyplus(path, file, diagnostics);
     }},
};

} // namespace

std::vector<std::string_view> factor_extensions() {
    std::vector<std::string_view> extensions;
    for (const FactorFormat& format : formats) {
        extensions.push_back(format.extension);
    }
    return extensions;
}

const FactorFormat& factor_format(const std::filesystem::path& path) {
    const std::string extension = is_standard_output(path) ? ".csv" : extension_of(path);
    const auto* const found =
        std::find_if(std::begin(formats), std::end(formats),
                     [&](const FactorFormat& format) { return format.extension == extension; });
    if (found == std::end(formats)) {
        throw InvalidArgument(fmt::format("{}: form factors are written as {}", path.string(),
                                          fmt::join(factor_extensions(), ", ")));
    }
    return *found;
}

void write_factors(const std::filesystem::path& path, const io::FactorFile& file,
                   const FactorContext& context, Diagnostics& diagnostics) {
    factor_format(path).write(path, file, context, diagnostics);
}

io::FactorFile read_factors(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".hff") {
        return io::read_hff(path);
    }
    if (extension == ".txt" || extension == ".vf") {
        return io::read_view3d(path, extension == ".vf" ? io::View3dFormat::binary : io::View3dFormat::text);
    }
    FactorFile file;
    if (extension == ".mtx") {
        file.factors = io::read_mtx(path);
    } else if (extension == ".csv") {
        file.factors = io::read_csv(path);
    } else if (extension == ".npz") {
        file.factors = io::read_npz(path);
    } else if (extension == ".dat" || extension == ".bin") {
        file.factors =
            io::read_elmer(path, extension == ".bin" ? io::ElmerFormat::binary : io::ElmerFormat::text);
    } else {
        throw InvalidArgument(
            fmt::format("{}: form factors are read from .hff, .mtx, .csv, .npz, .txt, .vf, .dat and .bin",
                        path.string()));
    }
    return file;
}

std::optional<FactorContent> factor_content(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".hff") {
        return FactorContent::all;
    }
    if (extension == ".txt" || extension == ".vf") {
        return FactorContent::areas;
    }
    constexpr std::string_view bare[] = {".mtx", ".csv", ".npz", ".dat", ".bin"};
    return std::find(std::begin(bare), std::end(bare), extension) != std::end(bare)
               ? std::optional(FactorContent::factors)
               : std::nullopt;
}

bool is_foreign_factor_file(const std::filesystem::path& path) {
    const auto content = factor_content(path);
    return content && *content != FactorContent::all;
}

} // namespace hemi::cli
