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
    "areas, group names, row balance (environment, blocked), settings and the "
    "geometry's hash";
constexpr std::string_view all_but_areas =
    "group names, row balance (environment, blocked), settings and the "
    "geometry's hash";

constexpr FactorFormat formats[] = {
    {".hff", "areas, names, row balance and the geometry's hash", "",
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_hff(path, file);
     }},
    {".mtx", "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_mtx(path, file.factors);
     }},
    {".csv", "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_csv(path, file.factors);
     }},
    {".npz", "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_npz(path, file.factors);
     }},
    {".h5", "", "visibilities and the better rows by which errors are estimated",
     [](const Path& path, const FactorFile& file, const FactorContext& context, Diagnostics&) {
         io::write_h5(path, file, repair_name(context.repair));
     }},
    {".txt", "areas", all_but_areas,
     [](const Path& path, const FactorFile& file, const FactorContext& context, Diagnostics&) {
         io::write_view3d(path, file, io::View3dFormat::text, context.emissivity);
     }},
    {".vf", "areas", all_but_areas,
     [](const Path& path, const FactorFile& file, const FactorContext& context, Diagnostics&) {
         io::write_view3d(path, file, io::View3dFormat::binary, context.emissivity);
     }},
    {".dat", "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_elmer(path, file.factors, io::ElmerFormat::text);
     }},
    {".bin", "", all_but_f,
     [](const Path& path, const FactorFile& file, const FactorContext&, Diagnostics&) {
         io::write_elmer(path, file.factors, io::ElmerFormat::binary);
     }},
    {".idf", "areas and group names",
     "factors of single patches, which are summed by group, areas, row balance (environment, blocked), "
     "settings and "
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

FormFactorMatrix read_bare_factors(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".mtx") {
        return io::read_mtx(path);
    }
    if (extension == ".csv") {
        return io::read_csv(path);
    }
    if (extension == ".npz") {
        return io::read_npz(path);
    }
    throw InvalidArgument(fmt::format("{}: form factors end in .hff, .mtx, .csv or .npz", path.string()));
}

bool is_bare_factor_file(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == ".mtx" || extension == ".csv" || extension == ".npz";
}

} // namespace hemi::cli
