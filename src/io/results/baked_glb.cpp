#include "hemi/core/error.hpp"
#include "hemi/io/baked_mesh_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/json_text.hpp"
#include "io/results/baked_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace hemi::io {

namespace {

constexpr std::uint64_t vertex_bytes = 3 * sizeof(float); // of each attribute

/// Patches of one group, and where its vertices and indices lie in the common buffers.
struct Part {
    std::uint32_t group = 0;
    std::vector<std::uint32_t> patches;
    std::uint64_t first_vertex = 0;
    std::uint64_t vertices = 0;
    std::uint64_t first_index = 0;
    std::uint64_t indices = 0;
    std::array<float, 3> lower{};
    std::array<float, 3> upper{};
};

class Baker {
public:
    Baker(const PatchMesh& mesh, std::span<const float> radiosity, double exposure)
        : mesh_(mesh), radiosity_(radiosity), exposure_(exposure), centre_(mesh.bounds().centre()) {
        make_parts();
    }

    void write(const std::filesystem::path& path) const {
        std::string json = json_text(document());
        json.resize((json.size() + 3) / 4 * 4, ' ');
        const std::uint64_t total = 12 + 8 + json.size() + 8 + buffer_bytes();
        if (total > std::numeric_limits<std::uint32_t>::max()) {
            throw InvalidArgument(
                fmt::format("{} patches take {} bytes; a .glb holds at most 4 GiB", mesh_.size(), total));
        }
        OutputFile file(path);
        file.write("glTF");
        write_words(file, {2, total, json.size()});
        file.write("JSON" + json);
        write_words(file, {buffer_bytes()});
        file.write("BIN\0", 4);
        write_attribute(file, [this](std::uint32_t patch, std::uint32_t corner) {
            return position(mesh_.corners(patch).points[corner]);
        });
        write_attribute(file, [this](std::uint32_t patch, std::uint32_t corner) {
            std::array<float, 3> colour = value(patch, corner);
            for (float& c : colour) {
                c = static_cast<float>(std::clamp(exposure_ * static_cast<double>(c), 0.0, 1.0));
            }
            return colour;
        });
        write_attribute(file,
                        [this](std::uint32_t patch, std::uint32_t corner) { return value(patch, corner); });
        write_indices(file);
        file.commit();
    }

private:
    [[nodiscard]] std::uint32_t corners(std::uint32_t patch) const {
        return mesh_.surfaces()[mesh_.surface_of()[patch]].vertex_count;
    }

    [[nodiscard]] std::array<float, 3> value(std::uint32_t patch, std::uint32_t corner) const {
        const std::size_t first = (std::size_t{patch} * 4 + corner) * 3;
        return {radiosity_[first], radiosity_[first + 1], radiosity_[first + 2]};
    }

    [[nodiscard]] std::array<float, 3> position(const Vec3& point) const {
        const Vec3 relative = point - centre_;
        return {static_cast<float>(relative.x), static_cast<float>(relative.y),
                static_cast<float>(relative.z)};
    }

    void make_parts() {
        std::vector<Part> all(mesh_.groups().size());
        for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
            all[mesh_.group(i)].patches.push_back(i);
        }
        for (std::uint32_t g = 0; g < all.size(); ++g) {
            Part& part = all[g];
            if (part.patches.empty()) {
                continue;
            }
            part.group = g;
            part.first_vertex = vertices_;
            part.first_index = indices_;
            part.lower.fill(std::numeric_limits<float>::max());
            part.upper.fill(std::numeric_limits<float>::lowest());
            for (const std::uint32_t patch : part.patches) {
                part.vertices += corners(patch);
                part.indices += corners(patch) == 3 ? 3 : 6;
                add_bounds(part, mesh_.corners(patch));
            }
            vertices_ += part.vertices;
            indices_ += part.indices;
            parts_.push_back(std::move(part));
        }
    }

    void add_bounds(Part& part, const PatchCorners& patch) const {
        for (const Vec3& corner : patch.polygon()) {
            const std::array<float, 3> point = position(corner);
            if (!std::all_of(point.begin(), point.end(), [](float x) { return std::isfinite(x); })) {
                throw InvalidArgument("the scene is too large for the 32-bit numbers of a .glb; scale it");
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                part.lower[axis] = std::min(part.lower[axis], point[axis]);
                part.upper[axis] = std::max(part.upper[axis], point[axis]);
            }
        }
    }

    [[nodiscard]] std::uint64_t buffer_bytes() const {
        return 3 * vertex_bytes * vertices_ + sizeof(std::uint32_t) * indices_;
    }

    [[nodiscard]] Json document() const {
        Json nodes = Json::array();
        Json meshes = Json::array();
        Json accessors = Json::array();
        Json children = Json::array();
        const auto attribute = [&](std::uint64_t view, const Part& part) {
            accessors.push_back({{"bufferView", view},
                                 {"byteOffset", part.first_vertex * vertex_bytes},
                                 {"componentType", 5126},
                                 {"type", "VEC3"},
                                 {"count", part.vertices}});
            return accessors.size() - 1;
        };
        for (const Part& part : parts_) {
            const std::size_t position = attribute(0, part);
            accessors.back()["min"] = part.lower;
            accessors.back()["max"] = part.upper;
            const std::size_t colour = attribute(1, part);
            const std::size_t radiosity = attribute(2, part);
            accessors.push_back({{"bufferView", 3},
                                 {"byteOffset", part.first_index * sizeof(std::uint32_t)},
                                 {"componentType", 5125},
                                 {"type", "SCALAR"},
                                 {"count", part.indices}});
            meshes.push_back(
                {{"name", mesh_.groups()[part.group]},
                 {"primitives",
                  Json::array({{{"attributes",
                                 {{"POSITION", position}, {"COLOR_0", colour}, {"_RADIOSITY", radiosity}}},
                                {"indices", accessors.size() - 1},
                                {"material", 0}}})}});
            nodes.push_back({{"name", mesh_.groups()[part.group]},
                             {"mesh", meshes.size() - 1},
                             {"translation", {centre_.x, centre_.y, centre_.z}}});
            children.push_back(nodes.size() - 1);
        }
        const std::uint64_t attribute_bytes = vertex_bytes * vertices_;
        Json views = Json::array();
        for (std::uint64_t k = 0; k < 3; ++k) {
            views.push_back({{"buffer", 0},
                             {"byteOffset", k * attribute_bytes},
                             {"byteLength", attribute_bytes},
                             {"target", 34962}});
        }
        views.push_back({{"buffer", 0},
                         {"byteOffset", 3 * attribute_bytes},
                         {"byteLength", sizeof(std::uint32_t) * indices_},
                         {"target", 34963}});
        return {{"asset", {{"version", "2.0"}, {"generator", "hemi " HEMI_VERSION}}},
                {"extensionsUsed", Json::array({"KHR_materials_unlit"})},
                {"scene", 0},
                {"scenes", Json::array({{{"nodes", children}}})},
                {"nodes", nodes},
                {"meshes", meshes},
                {"materials", Json::array({{{"name", "baked"},
                                            {"pbrMetallicRoughness",
                                             {{"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 0}}},
                                            {"extensions", {{"KHR_materials_unlit", Json::object()}}}}})},
                {"accessors", accessors},
                {"bufferViews", views},
                {"buffers", Json::array({{{"byteLength", buffer_bytes()}}})}};
    }

    static void write_words(OutputFile& file, std::initializer_list<std::uint64_t> values) {
        for (const std::uint64_t value : values) {
            const auto word = static_cast<std::uint32_t>(value);
            file.write(&word, sizeof word);
        }
    }

    template <class Value>
    void write_attribute(OutputFile& file, const Value& value_of) const {
        std::vector<float> values;
        for (const Part& part : parts_) {
            values.clear();
            values.reserve(3 * part.vertices);
            for (const std::uint32_t patch : part.patches) {
                for (std::uint32_t corner = 0; corner < corners(patch); ++corner) {
                    const std::array<float, 3> three = value_of(patch, corner);
                    values.insert(values.end(), three.begin(), three.end());
                }
            }
            file.write(values.data(), values.size() * sizeof(float));
        }
    }

    void write_indices(OutputFile& file) const {
        std::vector<std::uint32_t> indices;
        for (const Part& part : parts_) {
            indices.clear();
            indices.reserve(part.indices);
            std::uint32_t first = 0;
            for (const std::uint32_t patch : part.patches) {
                indices.insert(indices.end(), {first, first + 1, first + 2});
                if (corners(patch) == 4) {
                    indices.insert(indices.end(), {first, first + 2, first + 3});
                }
                first += corners(patch);
            }
            file.write(indices.data(), indices.size() * sizeof(std::uint32_t));
        }
    }

    const PatchMesh& mesh_;
    std::span<const float> radiosity_;
    double exposure_;
    Vec3 centre_;
    std::vector<Part> parts_;
    std::uint64_t vertices_ = 0;
    std::uint64_t indices_ = 0;
};

} // namespace

void write_baked_glb(const std::filesystem::path& path, const PatchMesh& mesh,
                     std::span<const float> radiosity, double exposure) {
    check_baked(mesh, radiosity, exposure);
    Baker(mesh, radiosity, exposure).write(path);
}

} // namespace hemi::io
