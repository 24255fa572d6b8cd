#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/vtp_file.hpp"
#include "io/formats/text_output.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace hemi::io {

namespace {

/// The columns of every patch table; group names are made ready once.
class PatchColumns {
public:
    PatchColumns(const PatchMesh& mesh, const PatchPlaces& left)
        : mesh_(mesh), areas_(mesh.areas()), centres_(mesh.centres()) {
        if (!left.areas.empty()) {
            if (left.areas.size() != mesh.size() || left.centres.size() != mesh.size()) {
                throw InvalidArgument(fmt::format("{} areas and {} centres for {} patches", left.areas.size(),
                                                  left.centres.size(), mesh.size()));
            }
            areas_ = left.areas;
            centres_ = left.centres;
        }
        for (const std::string& name : mesh.groups()) {
            groups_.push_back(csv_field(name));
        }
    }

    static constexpr const char* header = "index,group,area,cx,cy,cz,nx,ny,nz";

    void print(TextOutput& output, std::uint32_t patch) const {
        const Vec3& c = centres_[patch];
        const Vec3 n = mesh_.normal(patch) + Vec3(0.0); // no -0
        output.print(FMT_COMPILE("{},{},{},{},{},{},{},{},{}"), patch, groups_[mesh_.group(patch)],
                     areas_[patch], c.x, c.y, c.z, n.x, n.y, n.z);
    }

private:
    const PatchMesh& mesh_;
    std::span<const double> areas_;
    std::span<const Vec3> centres_;
    std::vector<std::string> groups_;
};

/// What there is one of for all channels.
bool is_share_of_row(std::string_view name) {
    return name == "environment" || name == "blocked" || name == "row_sum";
}

} // namespace

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        return text;
    }
    std::string result = "\"";
    for (const char letter : text) {
        result += letter == '"' ? "\"\"" : std::string(1, letter);
    }
    return result + '"';
}

void write_patch_table(const std::filesystem::path& path, const PatchMesh& mesh,
                       std::span<const CellArray> arrays, const PatchPlaces& left) {
    std::vector<std::string> names;
    for (const CellArray& array : arrays) {
        if (array.values.size() != mesh.size() * std::max<std::size_t>(array.components.size(), 1)) {
            throw InvalidArgument(fmt::format("{}: {} values for {} patches of {} components", array.name,
                                              array.values.size(), mesh.size(), array.components.size()));
        }
        if (array.components.empty()) {
            names.push_back(csv_field(array.name));
        }
        for (const std::string& component : array.components) {
            names.push_back(csv_field(fmt::format("{}_{}", array.name, component)));
        }
    }
    const PatchColumns columns(mesh, left);
    TextOutput output(path);
    output.print(FMT_COMPILE("{}"), PatchColumns::header);
    for (const std::string& name : names) {
        output.print(FMT_COMPILE(",{}"), name);
    }
    output.print(FMT_COMPILE("\n"));
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        columns.print(output, patch);
        for (const CellArray& array : arrays) {
            const std::size_t count = std::max<std::size_t>(array.components.size(), 1);
            for (const double value : std::span(array.values).subspan(patch * count, count)) {
                if (std::isnan(value)) {
                    output.print(FMT_COMPILE(","));
                } else {
                    output.print(FMT_COMPILE(",{}"), value);
                }
            }
        }
        output.print(FMT_COMPILE("\n"));
    }
    output.commit();
}

PatchPlaces places_left(const PatchMesh& as_read, const PatchMesh& mesh, const PatchParts& parts) {
    if (!parts.any()) {
        return {};
    }
    std::vector<double> coordinates;
    for (const Vec3& centre : mesh.centres()) {
        coordinates.insert(coordinates.end(), {centre.x, centre.y, centre.z});
    }
    const std::vector<double> means = means_of_patches(parts, mesh.areas(), coordinates, 3);
    PatchPlaces left{areas_of_patches(parts, mesh.areas()), {}};
    for (std::size_t i = 0; i < left.areas.size(); ++i) {
        left.centres.push_back(left.areas[i] > 0.0 ? Vec3(means[3 * i], means[3 * i + 1], means[3 * i + 2])
                                                   : as_read.centres()[i]);
    }
    return left;
}

void write_patches_csv(const std::filesystem::path& path, const PatchMesh& mesh, const PatchPlaces& left) {
    write_patch_table(path, mesh, {}, left);
}

void write_radiosity_csv(const std::filesystem::path& path, const ResultFile& result) {
    constexpr std::array<const char*, 14> columns{
        "exitance",      "irradiance",       "radiosity",   "error",   "direct",
        "reflectance",   "emissivity",       "environment", "blocked", "row_sum",
        "error_factors", "error_patch_size", "temperature", "net_flux"};
    const PatchMesh mesh(result.scene, result.subdivision);
    const std::vector<std::string>& channels = result.scene.channels;
    std::vector<CellArray> known = solution_arrays(result, mesh);
    std::vector<CellArray> arrays;
    for (const char* const name : columns) {
        const auto found = std::find_if(known.begin(), known.end(),
                                        [name](const CellArray& array) { return name == array.name; });
        if (found == known.end()) {
            continue;
        }
        CellArray& array = arrays.emplace_back(std::move(*found));
        const bool of_heat = array.name == "temperature" || array.name == "net_flux";
        if (!is_share_of_row(name) && !of_heat) {
            array.components = channels;
        }
        if (array.name == "exitance" && !result.solution.exitance.empty()) {
            array.values = result.solution.exitance;
        }
        const bool may_be_unknown =
            of_heat || array.name == "radiosity" || array.name == "irradiance" || array.name == "exitance";
        if (result.parts.any() && may_be_unknown && !result.solution.net_flux.empty()) {
            array = means_of_cells({std::move(array)}, result.parts, mesh.areas()).front();
        } else if (result.parts.any()) {
            array.values = means_of_patches(result.parts, mesh.areas(), array.values,
                                            std::max<std::size_t>(array.components.size(), 1));
        }
    }
    if (!result.parts.any()) {
        write_patch_table(path, mesh, arrays);
        return;
    }
    const PatchMesh as_read = result.patches_as_read();
    write_patch_table(path, as_read, arrays, places_left(as_read, mesh, result.parts));
}

} // namespace hemi::io
