#include "hemi/core/nearest_word.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/paths.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/formats/json_node.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mender.hpp"
#include "io/meshes/face_mesh.hpp"
#include "io/scenes/json_daylight.hpp"
#include "io/scenes/json_materials.hpp"
#include "io/scenes/json_symmetry.hpp"
#include "io/scenes/json_thermal.hpp"
#include "io/scenes/obj_materials.hpp"
#include "io/scenes/scene_folder.hpp"
#include "io/scenes/sides.hpp"
#include "io/scenes/transform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace hemi::io {

namespace {

/// A mesh that the scene names, and what MTL files say of its materials.
struct LoadedMesh {
    FaceMesh mesh;
    std::vector<std::optional<MtlMaterial>> materials;
    bool looked_up = false;
};

Transform read_transform(const JsonNode& node) {
    node.check_keys({"scale", "rotate", "translate"});
    Transform transform;
    if (node.has("scale")) {
        const JsonNode scale = node.member("scale");
        transform.scale = scale.value().is_array() ? scale.point() : Vec3(scale.number());
        if (transform.scale.x == 0.0 || transform.scale.y == 0.0 || transform.scale.z == 0.0) {
            scale.fail("0 makes a mesh flat; must not be 0");
        }
    }
    if (node.has("rotate")) {
        transform.degrees = node.member("rotate").point();
    }
    if (node.has("translate")) {
        transform.translate = node.member("translate").point();
    }
    return transform;
}

Grid read_grid(const JsonNode& node) {
    if (!node.value().is_array()) {
        const std::uint32_t n = node.count();
        return {n, n};
    }
    if (node.size() != 2) {
        node.expect("one number, or two [nu, nv]");
    }
    return {node.element(0).count(), node.element(1).count()};
}

/// @param up  its own, if it does not say another
Camera read_camera(const JsonNode& node, const Vec3& up) {
    node.check_keys({"eye", "target", "up", "fov", "orthographic"});
    Camera camera;
    camera.up = up;
    camera.eye = node.member("eye").point();
    camera.target = node.member("target").point();
    if (node.has("up")) {
        camera.up = node.member("up").point();
    }
    if (node.has("fov")) {
        const JsonNode fov = node.member("fov");
        camera.fov = fov.number();
        if (!(camera.fov > 0.0 && camera.fov < 180.0)) {
            fov.fail(fmt::format("{}; must be between 0 and 180 degrees", camera.fov));
        }
    }
    camera.orthographic = node.has("orthographic") && node.member("orthographic").boolean();
    const Vec3 view = camera.target - camera.eye;
    if (!(glm::length(view) > 0.0)) {
        node.fail("eye and target are the same point");
    }
    if (!(glm::length(glm::cross(view, camera.up)) > 1e-9 * glm::length(view) * glm::length(camera.up))) {
        node.fail("up is 0 or along the view; must point to a side of it");
    }
    return camera;
}

Enclosure read_enclosure(const JsonNode& node) {
    const std::string name = node.text();
    if (name == "auto") {
        return Enclosure::automatic;
    }
    if (name == "closed") {
        return Enclosure::closed;
    }
    if (name != "open") {
        node.fail(fmt::format("{}; must be \"closed\", \"open\" or \"auto\"", in_quotes(name)));
    }
    return Enclosure::open;
}

UpAxis read_up(const JsonNode& node) {
    const std::string name = node.text();
    const std::optional<UpAxis> up = from_word<UpAxis>(name);
    if (!up) {
        node.fail(fmt::format("{}; must be \"y\" or \"z\"", in_quotes(name)));
    }
    return *up;
}

bool has_three(const Json& material) {
    return material.is_object() && std::any_of(material.begin(), material.end(), [](const Json& value) {
               return value.is_array() && value.size() == 3 && !is_emissivity_table(value);
           });
}

class JsonSceneReader {
public:
    JsonSceneReader(const std::filesystem::path& path, const SceneReaderOptions& options,
                    Diagnostics& diagnostics)
        : path_(path), file_(path.string()), options_(options), diagnostics_(diagnostics),
          document_(parse_json(read_text(path), file_)), root_(document_, file_),
          folder_(path, options.allow_outside), mender_(options, "surface") {}

    Scene read() {
        check_version();
        const JsonNode surfaces = root_.member("surfaces");
        if (surfaces.size() == 0) {
            surfaces.fail("no surfaces; a scene needs at least one");
        }
        load_meshes(surfaces);
        read_channels();
        JsonMaterials materials(root_, scene_.channels, options_.adiabatic);
        for (std::size_t s = 0; s < surfaces.size(); ++s) {
            read_surface(surfaces.element(s), s, materials);
        }
        mender_.tell(file_, diagnostics_);
        scene_.materials = materials.take();
        read_settings();
        for (const auto& [index, lit] : fluxes_) {
            read_luminous_flux(surfaces.element(index), lit, scene_);
        }
        if (root_.has("groups")) {
            read_groups(root_.member("groups"), scene_);
        }
        check_units(root_, scene_);
        set_sides(scene_, options_, file_, diagnostics_);
        return std::move(scene_);
    }

private:
    void check_version() {
        root_.check_keys({"hemi", "name", "channels", "materials", "surfaces", "patch_size", "enclosure",
                          "environment", "camera", "groups", "bands", "unit", "sun", "up", "symmetry"});
        if (!root_.has("hemi")) {
            root_.fail("\"hemi\": 1 is missing, the version of the format");
        }
        const JsonNode version = root_.member("hemi");
        if (!version.value().is_number() || version.number() != 1.0) {
            version.expect("1, the only version of the format there is");
        }
    }

    [[nodiscard]] std::vector<std::string> own_material_names() const {
        std::vector<std::string> names;
        if (root_.has("materials")) {
            for (const auto& [name, ignored] : root_.value().at("materials").items()) {
                names.push_back(name);
            }
        }
        return names;
    }

    /// Before the channels are known: whether there are colours depends on the meshes' materials too.
    void load_meshes(const JsonNode& surfaces) {
        const std::vector<std::string> own = own_material_names();
        for (std::size_t s = 0; s < surfaces.size(); ++s) {
            const JsonNode surface = surfaces.element(s);
            if (!surface.value().is_object() || !surface.has("mesh")) {
                continue;
            }
            const JsonNode name = surface.member("mesh");
            const std::filesystem::path file = path_.parent_path() / name.text();
            if (!is_face_mesh(file)) {
                name.expect("the path of a mesh: " + mesh_extensions());
            }
            if (!folder_.allows(file)) {
                name.fail(SceneFolder::refusal(name.text()));
            }
            auto [entry, is_new] = meshes_.try_emplace(file.string());
            LoadedMesh& loaded = entry->second;
            if (is_new) {
                loaded.mesh = read_face_mesh(file, options_, diagnostics_);
                loaded.materials.resize(loaded.mesh.materials.size());
            }
            if (!surface.has("material") && !loaded.looked_up && extension_of(file) == ".obj") {
                loaded.materials =
                    find_obj_materials(loaded.mesh, own, folder_, options_.strict, diagnostics_);
                loaded.looked_up = true;
            }
        }
    }

    void read_channels() {
        if (options_.adiabatic) {
            (void)thermal_of(scene_); // which allows reflectances of 1
        }
        if (root_.has("bands")) {
            const JsonNode bands = root_.member("bands");
            thermal_of(scene_).band_limits = read_band_limits(bands);
            const std::size_t count = scene_.thermal->band_limits.size() + 1;
            if (!root_.has("channels")) {
                scene_.channels.clear();
                for (std::size_t k = 1; k <= count; ++k) {
                    scene_.channels.push_back(fmt::format("band_{}", k));
                }
                return;
            }
            if (root_.member("channels").size() != count) {
                bands.fail(fmt::format("{} limits make {} bands, and there are {} channels; must be as many",
                                       count - 1, count, root_.member("channels").size()));
            }
        }
        if (!root_.has("channels")) {
            scene_.channels = has_colours() ? std::vector<std::string>{"red", "green", "blue"}
                                            : std::vector<std::string>{"grey"};
            return;
        }
        const JsonNode channels = root_.member("channels");
        scene_.channels.clear();
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const JsonNode channel = channels.element(c);
            const std::string name = channel.text();
            if (std::count(scene_.channels.begin(), scene_.channels.end(), name) > 0) {
                channel.fail(fmt::format("{} is given twice", in_quotes(name)));
            }
            scene_.channels.push_back(name);
        }
        if (scene_.channels.empty()) {
            channels.fail("no channels; there must be at least one");
        }
    }

    [[nodiscard]] bool has_colours() const {
        const Json none = Json::object();
        const Json& materials = root_.has("materials") ? root_.value().at("materials") : none;
        const bool in_meshes = std::any_of(meshes_.begin(), meshes_.end(), [](const auto& loaded) {
            const auto& found = loaded.second.materials;
            return std::any_of(found.begin(), found.end(),
                               [](const auto& material) { return material.has_value(); });
        });
        return in_meshes ||
               (materials.is_object() && std::any_of(materials.begin(), materials.end(), has_three)) ||
               (root_.has("environment") && has_three(root_.value().at("environment")));
    }

    void read_surface(const JsonNode& node, std::size_t index, JsonMaterials& materials) {
        node.check_keys({"name", "group", "material", "polygon", "holes", "mesh", "transform", "patches",
                         "two_sided", "flip", "temperature", "heat_flux", "power", "isothermal",
                         "luminous_flux"});
        if (node.has("polygon") == node.has("mesh")) {
            node.fail(node.has("mesh") ? "both \"polygon\" and \"mesh\"; must have one of them"
                                       : "neither \"polygon\" nor \"mesh\"; must have one of them");
        }
        Surface common;
        common.two_sided = node.has("two_sided") && node.member("two_sided").boolean();
        if (node.has("patches")) {
            common.patches = read_grid(node.member("patches"));
        }
        if (const auto heat = read_heat(node)) {
            Thermal& thermal = thermal_of(scene_);
            common.heat = static_cast<std::uint32_t>(thermal.conditions.size());
            thermal.conditions.push_back(*heat);
        }
        const auto first = static_cast<std::uint32_t>(scene_.surfaces.size());
        if (node.has("mesh")) {
            if (node.has("holes")) {
                node.fail("\"holes\" belong to a polygon");
            }
            add_mesh(node, common, materials);
        } else {
            add_polygon(node, index, common, materials);
        }
        if (node.has("luminous_flux")) {
            std::vector<std::uint32_t>& lit = fluxes_[index];
            lit.resize(scene_.surfaces.size() - first);
            std::iota(lit.begin(), lit.end(), first);
        }
    }

    void add_polygon(const JsonNode& node, std::size_t index, Surface surface,
                     const JsonMaterials& materials) {
        if (node.has("transform")) {
            node.fail("\"transform\" belongs to a mesh; a polygon's vertices are in the scene's coordinates");
        }
        const JsonNode polygon = node.member("polygon");
        const std::vector<Vec3> outline = read_polygon(polygon);
        std::vector<std::vector<Vec3>> holes;
        if (node.has("holes")) {
            const JsonNode list = node.member("holes");
            for (std::size_t k = 0; k < list.size(); ++k) {
                holes.push_back(read_polygon(list.element(k)));
            }
        }
        surface.material = materials.index(node.member("material"));
        const std::string name =
            node.has("name") ? node.member("name").text() : fmt::format("surface_{}", index);
        const auto defect = mender_.mend(outline, holes, [index] {
            return FaceSpot{0, fmt::format("surfaces[{}]", index)};
        });
        if (defect) {
            polygon.fail(node.has("name") ? fmt::format("{} (surface \"{}\")", *defect, name) : *defect);
        }
        if (mender_.pieces().empty()) {
            return;
        }
        surface.vertex_count = outline.size() == 3 ? 3 : 4;
        check_grid(node, surface);
        surface.group = group(node.has("group") ? node.member("group").text() : name);
        for (const PolygonPiece& piece : mender_.pieces()) {
            Surface part = surface;
            part.vertices = piece.points;
            part.vertex_count = piece.count;
            part.continues = &piece != mender_.pieces().data();
            if (part.patches && part.vertex_count == 3) {
                part.patches->u = part.patches->v = std::max(part.patches->u, part.patches->v);
            }
            if (flips(node)) {
                turn_round(part);
            }
            scene_.surfaces.push_back(part);
        }
    }

    static std::vector<Vec3> read_polygon(const JsonNode& node) {
        if (node.size() < 3) {
            node.fail(fmt::format("{} vertices; a polygon needs 3 or more", node.size()));
        }
        std::vector<Vec3> points;
        for (std::size_t k = 0; k < node.size(); ++k) {
            points.push_back(node.element(k).point());
        }
        return points;
    }

    static bool flips(const JsonNode& node) { return node.has("flip") && node.member("flip").boolean(); }

    void add_mesh(const JsonNode& node, const Surface& common, JsonMaterials& materials) {
        const std::filesystem::path file = path_.parent_path() / node.member("mesh").text();
        const LoadedMesh& loaded = meshes_.at(file.string());
        Transform transform;
        if (node.has("transform")) {
            transform = read_transform(node.member("transform"));
        }
        const Placement place(transform);
        const std::vector<std::uint32_t> groups = mesh_groups(node, loaded.mesh);
        const std::vector<std::uint32_t> mesh_materials = this->mesh_materials(node, loaded, materials);
        for (const Surface& face : loaded.mesh.surfaces) {
            Surface surface = face;
            surface.two_sided = common.two_sided;
            surface.patches = common.patches;
            surface.heat = common.heat;
            surface.group = groups[face.group];
            surface.material = mesh_materials[face.material];
            std::transform(face.vertices.begin(), face.vertices.end(), surface.vertices.begin(), place);
            check_grid(node, surface);
            if (transform.mirrors() != flips(node)) {
                turn_round(surface);
            }
            scene_.surfaces.push_back(surface);
        }
    }

    std::vector<std::uint32_t> mesh_groups(const JsonNode& node, const FaceMesh& mesh) {
        if (node.has("group") || node.has("name")) {
            const std::string name = node.member(node.has("group") ? "group" : "name").text();
            return std::vector<std::uint32_t>(mesh.groups.size(), group(name));
        }
        std::vector<std::uint32_t> indices;
        for (const std::string& name : mesh.groups) {
            indices.push_back(group(name));
        }
        return indices;
    }

    static std::vector<std::uint32_t> mesh_materials(const JsonNode& node, const LoadedMesh& loaded,
                                                     JsonMaterials& materials) {
        if (node.has("material")) {
            return std::vector<std::uint32_t>(loaded.mesh.materials.size(),
                                              materials.index(node.member("material")));
        }
        std::vector<std::uint32_t> indices;
        for (std::size_t k = 0; k < loaded.mesh.materials.size(); ++k) {
            const std::string& name = loaded.mesh.materials[k].name;
            indices.push_back(
                materials.add(node.member("mesh"), name.empty() ? "default" : name, loaded.materials[k]));
        }
        return indices;
    }

    static void check_grid(const JsonNode& node, const Surface& surface) {
        if (surface.vertex_count == 3 && surface.patches && surface.patches->u != surface.patches->v) {
            node.member("patches").fail(fmt::format("[{}, {}] for a triangle; must be n or [n, n]",
                                                    surface.patches->u, surface.patches->v));
        }
    }

    std::uint32_t group(const std::string& name) {
        const auto [entry, is_new] = groups_.emplace(name, static_cast<std::uint32_t>(scene_.groups.size()));
        if (is_new) {
            scene_.groups.push_back(name);
        }
        return entry->second;
    }

    void read_settings() {
        scene_.name = root_.has("name") ? root_.member("name").text() : to_utf8(path_.stem().string());
        if (root_.has("patch_size")) {
            scene_.patch_size = root_.member("patch_size").positive();
        }
        if (root_.has("enclosure")) {
            scene_.enclosure = read_enclosure(root_.member("enclosure"));
        }
        if (root_.has("up")) {
            scene_.up = read_up(root_.member("up"));
        }
        scene_.up = options_.up.value_or(scene_.up);
        scene_.environment.assign(scene_.channels.size(), 0.0);
        if (root_.has("environment")) {
            const JsonNode environment = root_.member("environment");
            environment.check_keys({"exitance", "temperature", "sky", "horizontal_irradiance",
                                    "horizontal_illuminance", "ground"});
            read_sky(environment, scene_);
            if (environment.has("temperature")) {
                thermal_of(scene_).environment_temperature =
                    read_temperature(environment.member("temperature"));
            }
            if (environment.has("exitance") || !(environment.has("temperature") || scene_.sky)) {
                scene_.environment = channel_values(environment.member("exitance"), scene_.channels,
                                                    std::numeric_limits<double>::infinity());
            }
        }
        if (root_.has("sun")) {
            read_sun(root_.member("sun"), scene_, diagnostics_);
        }
        if (root_.has("unit")) {
            scene_.unit = read_unit(root_.member("unit"));
        }
        scene_.unit = options_.unit ? options_.unit : scene_.unit; // lumens go by it
        if (root_.has("symmetry")) {
            scene_.symmetry = read_symmetry(root_.member("symmetry"));
        }
        if (root_.has("camera")) {
            scene_.camera = read_camera(root_.member("camera"), upwards(scene_.up));
        }
    }

    std::filesystem::path path_;
    std::string file_;
    const SceneReaderOptions& options_;
    Diagnostics& diagnostics_;
    Json document_;
    JsonNode root_;
    SceneFolder folder_;
    FaceMender mender_;
    Scene scene_;
    std::map<std::string, LoadedMesh> meshes_;
    std::unordered_map<std::string, std::uint32_t> groups_;
    std::map<std::size_t, std::vector<std::uint32_t>> fluxes_; // surfaces by their node's index
};

} // namespace

Scene read_json_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                      Diagnostics& diagnostics) {
    return JsonSceneReader(path, options, diagnostics).read();
}

} // namespace hemi::io
