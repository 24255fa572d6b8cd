#include "hemi/core/error.hpp"
#include "hemi/io/baked_mesh_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/json_text.hpp"
#include "io/results/baked_mesh.hpp"
#include "io/results/png_16.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace hemi::io {

namespace {

/// One of a vertex, as floats.
struct Attribute {
    const char* name;
    std::uint32_t components;
    std::function<std::array<float, 3>(std::uint32_t patch, std::uint32_t corner)> value;

    [[nodiscard]] std::uint64_t bytes() const { return components * sizeof(float); }
};

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
    /// @param texture  null: the light is in the vertices' colours
    Baker(const PatchMesh& mesh, std::span<const float> radiosity, double exposure,
          const BakedTexture* texture)
        : mesh_(mesh), radiosity_(radiosity), exposure_(exposure), texture_(texture),
          centre_(mesh.bounds().centre()) {
        make_parts();
        add_attributes();
        if (texture_ != nullptr) {
            picture_ = encoded();
        }
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
        for (const Attribute& attribute : attributes_) {
            write_attribute(file, attribute);
        }
        write_indices(file);
        file.write(picture_ + std::string((4 - picture_.size() % 4) % 4, '\0'));
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

    void add_attributes() {
        attributes_.push_back({"POSITION", 3, [this](std::uint32_t patch, std::uint32_t corner) {
                                   return position(mesh_.corners(patch).points[corner]);
                               }});
        if (texture_ == nullptr) { // of which a colour would be a factor
            attributes_.push_back({"COLOR_0", 3, [this](std::uint32_t patch, std::uint32_t corner) {
                                       std::array<float, 3> colour = value(patch, corner);
                                       for (float& c : colour) {
                                           c = static_cast<float>(
                                               std::clamp(exposure_ * static_cast<double>(c), 0.0, 1.0));
                                       }
                                       return colour;
                                   }});
        }
        attributes_.push_back({"_RADIOSITY", 3, [this](std::uint32_t patch, std::uint32_t corner) {
                                   return value(patch, corner);
                               }});
        const auto place = [this](std::uint32_t patch, std::uint32_t corner) {
            const std::size_t at = (std::size_t{patch} * 4 + corner) * 2;
            return std::array<float, 3>{texture_->coordinates[at], texture_->coordinates[at + 1], 0.0F};
        };
        if (texture_ != nullptr) { // glTF has no second set without a first one
            attributes_.push_back({"TEXCOORD_0", 2, place});
            attributes_.push_back({"TEXCOORD_1", 2, place});
        }
    }

    /// The lightmap as a PNG.
    [[nodiscard]] std::string encoded() const {
        std::vector<std::uint16_t> values;
        values.reserve(texture_->texels.size());
        for (const float texel : texture_->texels) {
            const double x = std::clamp(exposure_ * static_cast<double>(texel), 0.0, 1.0);
            const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
            values.push_back(static_cast<std::uint16_t>(std::lround(65535.0 * srgb)));
        }
        return png_of_16_bits(texture_->size, texture_->size, values);
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
        return attribute_bytes() + sizeof(std::uint32_t) * indices_ + (picture_.size() + 3) / 4 * 4;
    }

    [[nodiscard]] std::uint64_t attribute_bytes() const {
        std::uint64_t bytes = 0;
        for (const Attribute& attribute : attributes_) {
            bytes += attribute.bytes() * vertices_;
        }
        return bytes;
    }

    /// Unlit in the vertices' colours, or black and shining by the lightmap: there are viewers that draw no
    /// texture of unlit materials, and others (VTK 9.1) none that shines without one of the base colour.
    [[nodiscard]] Json material() const {
        if (texture_ != nullptr) {
            const Json lightmap{{"index", 0}, {"texCoord", 1}};
            return {{"name", "baked"},
                    {"pbrMetallicRoughness",
                     {{"baseColorFactor", {0, 0, 0, 1}},
                      {"baseColorTexture", lightmap},
                      {"metallicFactor", 0},
                      {"roughnessFactor", 1}}},
                    {"emissiveFactor", {1, 1, 1}},
                    {"emissiveTexture", lightmap}};
        }
        return {{"name", "baked"},
                {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 0}}},
                {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
    }

    [[nodiscard]] Json document() const {
        Json nodes = Json::array();
        Json meshes = Json::array();
        Json accessors = Json::array();
        Json children = Json::array();
        for (const Part& part : parts_) {
            Json of_vertices = Json::object();
            for (std::size_t k = 0; k < attributes_.size(); ++k) {
                of_vertices[attributes_[k].name] = accessors.size();
                accessors.push_back({{"bufferView", k},
                                     {"byteOffset", part.first_vertex * attributes_[k].bytes()},
                                     {"componentType", 5126},
                                     {"type", attributes_[k].components == 2 ? "VEC2" : "VEC3"},
                                     {"count", part.vertices}});
                if (k == 0) {
                    accessors.back()["min"] = part.lower;
                    accessors.back()["max"] = part.upper;
                }
            }
            accessors.push_back({{"bufferView", attributes_.size()},
                                 {"byteOffset", part.first_index * sizeof(std::uint32_t)},
                                 {"componentType", 5125},
                                 {"type", "SCALAR"},
                                 {"count", part.indices}});
            meshes.push_back({{"name", mesh_.groups()[part.group]},
                              {"primitives", Json::array({{{"attributes", std::move(of_vertices)},
                                                           {"indices", accessors.size() - 1},
                                                           {"material", 0}}})}});
            nodes.push_back({{"name", mesh_.groups()[part.group]},
                             {"mesh", meshes.size() - 1},
                             {"translation", {centre_.x, centre_.y, centre_.z}}});
            children.push_back(nodes.size() - 1);
        }
        Json views = Json::array();
        std::uint64_t offset = 0;
        const auto add_view = [&](std::uint64_t bytes, int target) {
            views.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
            if (target != 0) {
                views.back()["target"] = target;
            }
            offset += bytes;
        };
        for (const Attribute& attribute : attributes_) {
            add_view(attribute.bytes() * vertices_, 34962);
        }
        add_view(sizeof(std::uint32_t) * indices_, 34963);
        Json json{{"asset", {{"version", "2.0"}, {"generator", "hemi " HEMI_VERSION}}},
                  {"scene", 0},
                  {"scenes", Json::array({{{"nodes", children}}})},
                  {"nodes", nodes},
                  {"meshes", meshes},
                  {"materials", Json::array({material()})},
                  {"accessors", accessors}};
        if (texture_ == nullptr) {
            json["extensionsUsed"] = Json::array({"KHR_materials_unlit"});
        } else {
            json["images"] = Json::array(
                {{{"name", "lightmap"}, {"mimeType", "image/png"}, {"bufferView", views.size()}}});
            json["samplers"] = Json::array( // linear, and no repetition
                {{{"magFilter", 9729}, {"minFilter", 9729}, {"wrapS", 33071}, {"wrapT", 33071}}});
            json["textures"] = Json::array({{{"sampler", 0}, {"source", 0}}});
            add_view(picture_.size(), 0);
        }
        json["bufferViews"] = views;
        json["buffers"] = Json::array({{{"byteLength", buffer_bytes()}}});
        return json;
    }

    static void write_words(OutputFile& file, std::initializer_list<std::uint64_t> values) {
        for (const std::uint64_t value : values) {
            const auto word = static_cast<std::uint32_t>(value);
            file.write(&word, sizeof word);
        }
    }

    void write_attribute(OutputFile& file, const Attribute& attribute) const {
        std::vector<float> values;
        for (const Part& part : parts_) {
            values.clear();
            values.reserve(attribute.components * part.vertices);
            for (const std::uint32_t patch : part.patches) {
                for (std::uint32_t corner = 0; corner < corners(patch); ++corner) {
                    const std::array<float, 3> three = attribute.value(patch, corner);
                    values.insert(values.end(), three.begin(), three.begin() + attribute.components);
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
    const BakedTexture* texture_;
    Vec3 centre_;
    std::vector<Attribute> attributes_;
    std::string picture_; ///< the lightmap as a file; empty: none
    std::vector<Part> parts_;
    std::uint64_t vertices_ = 0;
    std::uint64_t indices_ = 0;
};

} // namespace

void write_baked_glb(const std::filesystem::path& path, const PatchMesh& mesh,
                     std::span<const float> radiosity, double exposure) {
    check_baked(mesh, radiosity, exposure);
    Baker(mesh, radiosity, exposure, nullptr).write(path);
}

void write_lightmapped_glb(const std::filesystem::path& path, const PatchMesh& mesh,
                           std::span<const float> radiosity, double exposure, const BakedTexture& texture) {
    check_baked(mesh, radiosity, exposure);
    if (texture.coordinates.size() != std::size_t{mesh.size()} * 8 ||
        texture.texels.size() != std::size_t{texture.size} * texture.size * 3) {
        throw InvalidArgument("a texture of another mesh, or of other numbers of texels");
    }
    Baker(mesh, radiosity, exposure, &texture).write(path);
}

} // namespace hemi::io
