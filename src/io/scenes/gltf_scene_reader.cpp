#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mender.hpp"
#include "io/scenes/gltf_file.hpp"
#include "io/scenes/mtl_reader.hpp"
#include "io/scenes/sides.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

namespace hemi::io {

namespace {

using Matrix = glm::dmat4;

constexpr std::size_t most_faces = 10'000'000; // nodes share meshes: a small file can ask for any number
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Array member `key` of the document, as one that may be missing.
class Elements {
public:
    Elements(const JsonNode& root, std::string_view key)
        : node_(root.has(key) ? root.member(key) : JsonNode(empty(), no_file())), size_(node_.size()) {}

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] JsonNode operator[](std::size_t k) const { return node_.element(k); }

private:
    static const Json& empty() {
        static const Json array = Json::array();
        return array;
    }
    static const std::string& no_file() {
        static const std::string name;
        return name;
    }

    JsonNode node_;
    std::size_t size_;
};

std::array<double, 4> read_numbers(const JsonNode& node, std::size_t count) {
    if (node.size() != count) {
        node.expect(fmt::format("{} numbers", count));
    }
    std::array<double, 4> values{};
    for (std::size_t k = 0; k < count; ++k) {
        values[k] = node.element(k).number();
    }
    return values;
}

Matrix rotation(const JsonNode& node) {
    const auto q = read_numbers(node, 4);
    const double length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    if (!(length > 1e-6) || !std::isfinite(length)) {
        node.fail("not a rotation; must be a unit quaternion [x, y, z, w]");
    }
    const double x = q[0] / length;
    const double y = q[1] / length;
    const double z = q[2] / length;
    const double w = q[3] / length;
    Matrix m(1.0);
    m[0] = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0};
    m[1] = {2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0};
    m[2] = {2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0};
    return m;
}

Matrix local_matrix(const JsonNode& node) {
    Matrix m(1.0);
    if (node.has("matrix")) {
        const JsonNode given = node.member("matrix");
        const std::vector<double> values = given.numbers();
        if (values.size() != 16) {
            given.expect("16 numbers, column by column");
        }
        for (int k = 0; k < 16; ++k) {
            m[k / 4][k % 4] = values[static_cast<std::size_t>(k)];
        }
        if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0) {
            given.fail("the last row must be 0, 0, 0, 1");
        }
        return m;
    }
    if (node.has("rotation")) {
        m = rotation(node.member("rotation"));
    }
    if (node.has("scale")) {
        const Vec3 scale = node.member("scale").point();
        for (int axis = 0; axis < 3; ++axis) {
            m[axis] *= scale[axis];
        }
    }
    if (node.has("translation")) {
        m[3] = glm::dvec4(node.member("translation").point(), 1.0);
    }
    return m;
}

class GltfSceneReader {
public:
    GltfSceneReader(const std::filesystem::path& path, const SceneReaderOptions& options,
                    Diagnostics& diagnostics)
        : file_(path.string()), gltf_(path, options.allow_outside), options_(options),
          diagnostics_(diagnostics), nodes_(gltf_.root(), "nodes"), meshes_(gltf_.root(), "meshes"),
          materials_(gltf_.root(), "materials"), cameras_(gltf_.root(), "cameras"),
          mender_(options, "triangle"), material_indices_(materials_.size() + 1, none),
          quantized_(gltf_.uses("KHR_mesh_quantization")) {
        scene_.name = to_utf8(path.stem().string());
        scene_.up = UpAxis::y;
    }

    Scene read() {
        set_channels();
        tell_unused();
        visit_all();
        if (scene_.surfaces.empty()) {
            throw InputError(fmt::format("{}: no triangles; a scene needs at least one", file_));
        }
        tell_left_out();
        std::vector<bool> groups;
        if (options_.close_bodies) {
            groups.assign(scene_.groups.size(), true);
        }
        set_sides(scene_, options_, file_, diagnostics_, std::move(groups));
        tell_double_sided();
        return std::move(scene_);
    }

private:
    struct Visit {
        std::size_t node;
        Matrix parent;
    };

    void set_channels() {
        scene_.channels = materials_.size() > 0 ? std::vector<std::string>{"red", "green", "blue"}
                                                : std::vector<std::string>{"grey"};
        scene_.environment.assign(scene_.channels.size(), 0.0);
    }

    void warn(const std::string& message) { diagnostics_.warn(fmt::format("{}: {}", file_, message)); }

    void tell_unused() {
        static const std::set<std::string> used{"KHR_materials_emissive_strength", "KHR_materials_unlit",
                                                "KHR_texture_transform", "KHR_mesh_quantization"};
        std::vector<std::string> unused;
        const Elements extensions(gltf_.root(), "extensionsUsed");
        for (std::size_t k = 0; k < extensions.size(); ++k) {
            if (!used.contains(extensions[k].text())) {
                unused.push_back(extensions[k].text());
            }
        }
        for (const char* what : {"skins", "animations"}) {
            if (gltf_.root().has(what)) {
                unused.emplace_back(what);
            }
        }
        if (!unused.empty()) {
            warn(fmt::format("not used: {}", fmt::join(unused, ", ")));
        }
    }

    /// Every node of the scene after its parent, in the file's order.
    void visit_all() {
        std::vector<bool> seen(nodes_.size(), false);
        std::vector<Visit> open;
        for (const std::size_t node : roots()) {
            open.push_back({node, Matrix(1.0)});
        }
        std::reverse(open.begin(), open.end());
        while (!open.empty()) {
            const Visit visit = open.back();
            open.pop_back();
            const JsonNode node = nodes_[visit.node];
            node.check_object();
            if (seen[visit.node]) {
                node.fail("is reached twice; nodes must form a tree");
            }
            seen[visit.node] = true;
            const Matrix matrix = visit.parent * local_matrix(node);
            read_node(node, visit.node, matrix);
            if (node.has("children")) {
                const JsonNode children = node.member("children");
                for (std::size_t k = children.size(); k-- > 0;) {
                    open.push_back({GltfFile::index(children.element(k), nodes_.size(), "nodes"), matrix});
                }
            }
        }
    }

    /// The roots of the scene that is to be shown; without scenes, the nodes that are no one's child.
    [[nodiscard]] std::vector<std::size_t> roots() const {
        std::vector<std::size_t> found;
        const Elements scenes(gltf_.root(), "scenes");
        if (scenes.size() > 0) {
            const std::size_t shown =
                gltf_.root().has("scene")
                    ? GltfFile::index(gltf_.root().member("scene"), scenes.size(), "scenes")
                    : 0;
            const JsonNode scene = scenes[shown];
            scene.check_object();
            if (scene.has("nodes")) {
                const JsonNode list = scene.member("nodes");
                for (std::size_t k = 0; k < list.size(); ++k) {
                    found.push_back(GltfFile::index(list.element(k), nodes_.size(), "nodes"));
                }
            }
            return found;
        }
        std::vector<bool> is_child(nodes_.size(), false);
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const JsonNode node = nodes_[n];
            if (node.value().is_object() && node.has("children")) {
                const JsonNode children = node.member("children");
                for (std::size_t k = 0; k < children.size(); ++k) {
                    is_child[GltfFile::index(children.element(k), nodes_.size(), "nodes")] = true;
                }
            }
        }
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (!is_child[n]) {
                found.push_back(n);
            }
        }
        return found;
    }

    void read_node(const JsonNode& node, std::size_t number, const Matrix& matrix) {
        if (node.has("camera") && !scene_.camera) {
            read_camera(cameras_[GltfFile::index(node.member("camera"), cameras_.size(), "cameras")], matrix);
        }
        if (!node.has("mesh")) {
            return;
        }
        const JsonNode reference = node.member("mesh");
        const JsonNode mesh = meshes_[GltfFile::index(reference, meshes_.size(), "meshes")];
        const JsonNode primitives = mesh.member("primitives");
        const std::uint32_t group = group_of(node, mesh, number);
        for (std::size_t k = 0; k < primitives.size(); ++k) {
            read_primitive(primitives.element(k), number, group, matrix);
        }
    }

    std::uint32_t group_of(const JsonNode& node, const JsonNode& mesh, std::size_t number) {
        std::string name = node.has("name") ? node.member("name").any_text() : std::string();
        if (name.empty() && mesh.has("name")) {
            name = mesh.member("name").any_text();
        }
        if (name.empty()) {
            name = fmt::format("node_{}", number);
        }
        const auto [entry, is_new] = groups_.emplace(name, static_cast<std::uint32_t>(scene_.groups.size()));
        if (is_new) {
            scene_.groups.push_back(name);
        }
        return entry->second;
    }

    void read_primitive(const JsonNode& primitive, std::size_t node, std::uint32_t group,
                        const Matrix& matrix) {
        primitive.check_object();
        count(primitive, 1);
        const std::uint64_t mode = primitive.has("mode") ? primitive.member("mode").integer(6) : 4;
        if (mode < 4) {
            ++without_faces_;
            return;
        }
        if (primitive.has("targets")) {
            has_morph_targets_ = true;
        }
        const JsonNode attributes = primitive.member("attributes");
        const JsonNode position = attributes.member("POSITION");
        const GltfAccessor points = gltf_.accessor(position);
        const bool is_float = points.component() == GltfAccessor::Component::f32;
        const bool is_short = !is_float && points.component() != GltfAccessor::Component::u32;
        if (points.components() != 3 || !(is_float || (is_short && quantized_))) {
            position.fail("must be an accessor of VEC3 of floats (5126); of 8 or 16 bits with the extension "
                          "KHR_mesh_quantization");
        }
        const bool indexed = primitive.has("indices");
        const std::size_t corners =
            indexed ? read_indices(primitive.member("indices"), points.count()) : points.count();
        constexpr std::uint64_t list = 4;
        constexpr std::uint64_t strip = 5;
        if (mode == list ? corners % 3 != 0 : corners < 3) {
            primitive.fail(fmt::format("{} {}; triangles need {}", corners, indexed ? "indices" : "positions",
                                       mode == list ? "a multiple of 3" : "at least 3"));
        }
        const std::size_t triangles = mode == list ? corners / 3 : corners - 2;
        count(primitive, triangles);
        const bool mirrors = glm::determinant(glm::dmat3(matrix)) < 0.0;
        Surface surface;
        surface.vertex_count = 3;
        surface.group = group;
        surface.material = material_of(primitive, surface.two_sided);
        for (std::size_t t = 0; t < triangles; ++t) {
            // Every other triangle of a strip runs along its edge the other way; those of a fan share corner
            // 0.
            const std::array<std::size_t, 3> of_triangle =
                mode == list    ? std::array{3 * t, 3 * t + 1, 3 * t + 2}
                : mode == strip ? std::array{t, t + 1 + t % 2, t + 2 - t % 2}
                                : std::array{t + 1, t + 2, std::size_t{0}};
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t place = indexed ? indices_[of_triangle[c]] : of_triangle[c];
                surface.vertices[mirrors ? 2 - c : c] = Vec3(matrix * glm::dvec4(points.point(place), 1.0));
            }
            add(surface, primitive, t, node);
        }
    }

    void count(const JsonNode& primitive, std::size_t work) {
        if (work > most_faces - counted_) {
            primitive.fail(fmt::format("more than {} triangles and primitives in all", most_faces));
        }
        counted_ += work;
    }

    /// Reads them to indices_. Every one is below `positions`.
    std::size_t read_indices(const JsonNode& reference, std::size_t positions) {
        const GltfAccessor accessor = gltf_.accessor(reference);
        if (accessor.components() != 1 || !is_unsigned(accessor.component())) {
            reference.fail("must be an accessor of SCALAR of unsigned integers (5121, 5123 or 5125)");
        }
        if (accessor.count() / 3 > most_faces) {
            reference.fail(fmt::format("more than {} triangles", most_faces));
        }
        indices_.resize(accessor.count());
        for (std::size_t k = 0; k < indices_.size(); ++k) {
            indices_[k] = accessor.integer(k);
            if (indices_[k] >= positions) {
                reference.fail(
                    fmt::format("index {} is {}; there are {} positions", k, indices_[k], positions));
            }
        }
        return indices_.size();
    }

    void add(const Surface& surface, const JsonNode& primitive, std::size_t triangle, std::size_t node) {
        const auto defect = mender_.mend(surface.polygon(), [&] {
            return FaceSpot{0, fmt::format("triangle {} of {}", triangle, primitive.path())};
        });
        if (defect) {
            primitive.fail(fmt::format("triangle {} (placed by nodes[{}]): {}", triangle, node, *defect));
        }
        if (!mender_.pieces().empty()) {
            scene_.surfaces.push_back(surface);
        }
    }

    std::uint32_t material_of(const JsonNode& primitive, bool& two_sided) {
        const bool given = primitive.has("material");
        const std::size_t index =
            given ? GltfFile::index(primitive.member("material"), materials_.size(), "materials")
                  : materials_.size();
        if (given) {
            const JsonNode material = materials_[index];
            material.check_object();
            two_sided = material.has("doubleSided") && material.member("doubleSided").boolean();
        }
        std::uint32_t& known = material_indices_[index];
        if (known == none) {
            known = static_cast<std::uint32_t>(scene_.materials.size());
            const std::size_t channels = scene_.channels.size();
            scene_.materials.push_back(given ? read_material(materials_[index], index)
                                             : Material{"default", std::vector<double>(channels, 0.5),
                                                        std::vector<double>(channels, 0.0)});
        }
        return known;
    }

    Material read_material(const JsonNode& node, std::size_t number) {
        Material material;
        material.name =
            node.has("name") ? node.member("name").any_text() : fmt::format("material_{}", number);
        material.reflectance = {1.0, 1.0, 1.0};
        if (node.has("pbrMetallicRoughness")) {
            const JsonNode pbr = node.member("pbrMetallicRoughness");
            pbr.check_object();
            textures_ = textures_ || pbr.has("baseColorTexture");
            if (pbr.has("baseColorFactor")) {
                const JsonNode colour = pbr.member("baseColorFactor");
                material.reflectance = colours(colour, 4, 1.0);
                transparent_ = transparent_ || colour.element(3).number() < 1.0;
            }
            constexpr double half = 0.5;
            if (pbr.has("metallicFactor") && pbr.member("metallicFactor").number() > half) {
                metals_.insert(material.name);
            }
        }
        for (double& value : material.reflectance) {
            if (value > most_reflectance) {
                value = most_reflectance;
                limited_.insert(material.name);
            }
        }
        material.exitance = {0.0, 0.0, 0.0};
        if (node.has("emissiveFactor")) {
            material.exitance = colours(node.member("emissiveFactor"), 3, 1.0);
        }
        const double strength = emissive_strength(node);
        for (double& value : material.exitance) {
            value *= strength;
        }
        textures_ = textures_ || node.has("emissiveTexture");
        transparent_ = transparent_ || (node.has("alphaMode") && node.member("alphaMode").text() != "OPAQUE");
        return material;
    }

    static double emissive_strength(const JsonNode& material) {
        if (!material.has("extensions")) {
            return 1.0;
        }
        const JsonNode extensions = material.member("extensions");
        extensions.check_object();
        if (!extensions.has("KHR_materials_emissive_strength")) {
            return 1.0;
        }
        const JsonNode extension = extensions.member("KHR_materials_emissive_strength");
        extension.check_object();
        if (!extension.has("emissiveStrength")) {
            return 1.0;
        }
        const JsonNode strength = extension.member("emissiveStrength");
        if (!(strength.number() >= 0.0)) {
            strength.expect("a number that is not negative");
        }
        return strength.number();
    }

    static std::vector<double> colours(const JsonNode& node, std::size_t count, double most) {
        const auto values = read_numbers(node, count);
        for (std::size_t k = 0; k < count; ++k) {
            if (!(values[k] >= 0.0 && values[k] <= most)) {
                node.element(k).expect(fmt::format("a number from 0 to {}", most));
            }
        }
        return {values.begin(), values.begin() + 3};
    }

    /// Looks along -z, y is up. Others than perspective ones are left out.
    void read_camera(const JsonNode& node, const Matrix& matrix) {
        node.check_object();
        if (!node.has("perspective")) {
            return;
        }
        const JsonNode perspective = node.member("perspective");
        const double fov = glm::degrees(perspective.member("yfov").positive());
        const Vec3 eye(matrix[3]);
        const Vec3 back(matrix[2]);
        const Vec3 up(matrix[1]);
        if (!(fov < 180.0) || !(glm::length(back) > 0.0) ||
            !(glm::length(glm::cross(back, up)) > 1e-9 * glm::length(back) * glm::length(up))) {
            perspective.fail("a camera that looks nowhere: yfov must be below pi, its node's scale not 0");
        }
        scene_.camera = Camera{eye, eye - glm::normalize(back), glm::normalize(up), fov};
    }

    void tell_double_sided() {
        const auto count =
            static_cast<std::size_t>(std::count_if(scene_.surfaces.begin(), scene_.surfaces.end(),
                                                   [](const Surface& surface) { return surface.two_sided; }));
        if (options_.close_bodies && 2 * count > scene_.surfaces.size() &&
            options_.one_sided_groups.empty() && options_.two_sided_groups.empty()) {
            warn(fmt::format(
                "{} of {} triangles are double-sided, as exporters mark them by default: their backs count "
                "as surfaces of their own (--one-sided-group makes groups one-sided)",
                count, scene_.surfaces.size()));
        }
    }

    void tell_left_out() {
        if (without_faces_ > 0) {
            warn(fmt::format("{} of points or lines left out",
                             plural(without_faces_, "primitive", "primitives")));
        }
        mender_.tell(file_, diagnostics_);
        if (has_morph_targets_) {
            warn("morph targets are not used");
        }
        if (textures_) {
            warn("textures are not used; baseColorFactor and emissiveFactor count");
        }
        if (transparent_) {
            warn("transparency is not used; every surface is opaque");
        }
        if (!metals_.empty()) {
            warn(fmt::format("metals mirror light, and are taken as diffuse in their base colours: {}",
                             fmt::join(metals_, ", ")));
        }
        if (!limited_.empty()) {
            warn(
                fmt::format("reflectance {} instead of the base colour's 1 in {} (no surface reflects all it "
                            "receives)",
                            most_reflectance, fmt::join(limited_, ", ")));
        }
    }

    std::string file_;
    GltfFile gltf_;
    const SceneReaderOptions& options_;
    Diagnostics& diagnostics_;
    Elements nodes_;
    Elements meshes_;
    Elements materials_;
    Elements cameras_;
    Scene scene_;
    FaceMender mender_;
    std::vector<std::uint32_t> material_indices_; ///< of glTF's materials and, last, of none; `none`: not yet
    std::unordered_map<std::string, std::uint32_t> groups_;
    std::vector<std::uint32_t> indices_; // kept between primitives for their memory
    std::set<std::string> limited_;
    std::set<std::string> metals_;
    std::size_t counted_ = 0; ///< primitives and triangles, as often as nodes place them
    std::size_t without_faces_ = 0;
    bool quantized_; ///< positions may be integers
    bool has_morph_targets_ = false;
    bool textures_ = false;
    bool transparent_ = false;
};

} // namespace

Scene read_gltf_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                      Diagnostics& diagnostics) {
    return GltfSceneReader(path, options, diagnostics).read();
}

} // namespace hemi::io
