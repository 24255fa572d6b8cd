#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/dense_rows.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/text_output.hpp"

#include <algorithm>
#include <cmath>

namespace hemi::io {

namespace {

constexpr double least_emissivity = 0.001; // View3D's own limits
constexpr double largest_emissivity = 0.999;

/// "program version format enclosure script-F N", filled up to 30 characters, which is how View3D's readers
/// take it.
std::string header_line(const FormFactors& file, View3dFormat format) {
    return fmt::format("{:<30}",
                       fmt::format("hemi {} {} {} 0 {}", HEMI_VERSION, format == View3dFormat::text ? 0 : 1,
                                   file.enclosure == Enclosure::closed ? 1 : 0, file.matrix.size()));
}

double emissivity_of(std::span<const double> emissivity, std::size_t patch) {
    return emissivity.empty() ? largest_emissivity
                              : std::clamp(emissivity[patch], least_emissivity, largest_emissivity);
}

void write_text(const std::filesystem::path& path, const FormFactors& file,
                std::span<const double> emissivity) {
    TextOutput output(path);
    output.print(FMT_COMPILE("{}\n"), header_line(file, View3dFormat::text));
    const std::uint32_t size = file.matrix.size();
    for (std::uint32_t i = 0; i < size; ++i) {
        output.print(FMT_COMPILE("{}{:.9g}"), i == 0 ? "" : " ", file.areas[i]);
    }
    output.print(FMT_COMPILE("\n"));
    for (std::uint32_t i = 0; i < size; ++i) {
        const RowView row = file.matrix.row(i);
        std::size_t k = 0;
        for (std::uint32_t j = 0; j < size; ++j) {
            const bool stored = k < row.columns.size() && row.columns[k] == j;
            output.print(FMT_COMPILE("{}{:.9g}"), j == 0 ? "" : " ", stored ? row.values[k] : 0.0f);
            k += stored ? 1 : 0;
        }
        output.print(FMT_COMPILE("\n"));
    }
    for (std::uint32_t i = 0; i < size; ++i) {
        output.print(FMT_COMPILE("{}{:.9g}"), i == 0 ? "" : " ", emissivity_of(emissivity, i));
    }
    output.print(FMT_COMPILE("\n"));
    output.commit();
}

void write_binary(const std::filesystem::path& path, const FormFactors& file,
                  std::span<const double> emissivity) {
    OutputFile output(path);
    output.write(header_line(file, View3dFormat::binary) + "\r\n");
    const std::uint32_t size = file.matrix.size();
    std::vector<float> line(size);
    const auto write_line = [&] { output.write(line.data(), line.size() * sizeof(float)); };
    for (std::uint32_t i = 0; i < size; ++i) {
        line[i] = static_cast<float>(file.areas[i]);
        if (!(std::isfinite(line[i]) && (line[i] > 0.0f || file.areas[i] == 0.0))) {
            throw InvalidArgument(fmt::format("patch {}: an area of {}, which this format's 32 bits cannot "
                                              "hold; scale the scene, or write .txt",
                                              i, file.areas[i]));
        }
    }
    write_line();
    write_dense_rows(output, file.matrix);
    for (std::uint32_t i = 0; i < size; ++i) {
        line[i] = static_cast<float>(emissivity_of(emissivity, i));
    }
    write_line();
    output.commit();
}

} // namespace

void write_view3d(const std::filesystem::path& path, const FormFactors& file, View3dFormat format,
                  std::span<const double> emissivity) {
    require_all_known(file.matrix, "a View3D file");
    const std::size_t size = file.matrix.size();
    if (file.areas.size() != size || (!emissivity.empty() && emissivity.size() != size)) {
        throw InvalidArgument(fmt::format("{} areas and {} emissivities for {} rows", file.areas.size(),
                                          emissivity.size(), size));
    }
    if (format == View3dFormat::text) {
        write_text(path, file, emissivity);
    } else {
        write_binary(path, file, emissivity);
    }
}

} // namespace hemi::io
