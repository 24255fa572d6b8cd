#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/paths.hpp"
#include "io/formats/text_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace hemi::io {

namespace {

using Path = std::filesystem::path;

constexpr std::string_view all_but_f =
    "areas, group names, row balance (environment, blocked), settings and the geometry's hash";
constexpr std::string_view all_but_areas =
    "group names, row balance (environment, blocked), settings and the geometry's hash";

constexpr FactorFormat formats[] = {
    {".hff", FactorContent::all, "areas, names, row balance and the geometry's hash", "",
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_hff(path, file);
     }},
    {".mtx", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_mtx(path, file.matrix);
     }},
    {".csv", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_csv(path, file.matrix);
     }},
    {".npz", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_npz(path, file.matrix);
     }},
    {".npy", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_npy(path, file.matrix);
     }},
#ifdef HEMI_WITH_HDF5
    {".h5", FactorContent::factors, "", "visibilities and the better rows by which errors are estimated",
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_h5(path, file);
     }},
#endif
    {".txt", FactorContent::areas, "areas", all_but_areas,
     [](const Path& path, const FormFactors& file, const FactorContext& context, Diagnostics&) {
         write_view3d(path, file, View3dFormat::text, context.emissivity);
     }},
    {".vf", FactorContent::areas, "areas", all_but_areas,
     [](const Path& path, const FormFactors& file, const FactorContext& context, Diagnostics&) {
         write_view3d(path, file, View3dFormat::binary, context.emissivity);
     }},
    {".dat", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_elmer(path, file.matrix, ElmerFormat::text);
     }},
    {".bin", FactorContent::factors, "", all_but_f,
     [](const Path& path, const FormFactors& file, const FactorContext&, Diagnostics&) {
         write_elmer(path, file.matrix, ElmerFormat::binary);
     }},
    {".idf", FactorContent::all, "areas and group names",
     "factors of single patches (groups' are there), areas, row balance (environment, blocked), settings and "
     "the geometry's hash",
     [](const Path& path, const FormFactors& file, const FactorContext& context, Diagnostics& diagnostics) {
         write_energyplus(path, file, diagnostics, context.zone);
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

void write_factors(const std::filesystem::path& path, const FormFactors& file, const FactorContext& context,
                   Diagnostics& diagnostics) {
    const FactorFormat& format = factor_format(path);
    // Groups are summed over clusters exactly; all other formats have a column a patch.
    if (file.matrix.clusters() != nullptr && format.extension != ".hff" && format.extension != ".idf") {
        throw InvalidArgument(fmt::format("{}: far patches stand in clusters; {} holds factors of single "
                                          "patches",
                                          path.string(), format.extension));
    }
    format.write(path, file, context, diagnostics);
}

FormFactors read_factors(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".hff") {
        return read_hff(path);
    }
    if (extension == ".txt" || extension == ".vf") {
        return read_view3d(path, extension == ".vf" ? View3dFormat::binary : View3dFormat::text);
    }
    FormFactors file;
    if (extension == ".mtx") {
        file.matrix = read_mtx(path);
    } else if (extension == ".csv") {
        file.matrix = read_csv(path);
    } else if (extension == ".npz") {
        file.matrix = read_npz(path);
    } else if (extension == ".dat" || extension == ".bin") {
        file.matrix = read_elmer(path, extension == ".bin" ? ElmerFormat::binary : ElmerFormat::text);
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

void write_group_factors_csv(const std::filesystem::path& path, std::span<const std::string> names,
                             const GroupFactors& groups) {
    std::string text = "group,area";
    for (const std::string& name : names) {
        text += ',' + csv_field(name);
    }
    text += ",environment,blocked\n";
    for (std::uint32_t g = 0; g < groups.groups; ++g) {
        text += fmt::format("{},{}", csv_field(names[g]), groups.areas[g]);
        for (std::uint32_t h = 0; h < groups.groups; ++h) {
            text += fmt::format(",{}", groups.factors[std::size_t{g} * groups.groups + h]);
        }
        text += fmt::format(",{},{}\n", groups.environment[g], groups.blocked[g]);
    }
    OutputFile output(path);
    output.write(text);
    output.commit();
}

} // namespace hemi::io
