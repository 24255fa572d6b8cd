#include "hemi/core/error.hpp"
#include "hemi/io/paths.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/scenes/json_symmetry.hpp"
#include "io/scenes/sides.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace hemi::io {

namespace {

/// Adds scenes to one another, each as groups of its own.
class JoinedScenes {
public:
    /// @param path  that the scene was read from
    void add(const std::filesystem::path& path, Scene scene) {
        const std::string name = path.stem().string();
        if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
            throw InputError(fmt::format("{}: another file is called {}, too, and groups are named by their "
                                         "files; rename one",
                                         path.string(), name));
        }
        names_.push_back(name);
        if (names_.size() == 1) {
            result_.channels = scene.channels;
            result_.enclosure = scene.enclosure;
            result_.up = scene.up;
        }
        take_channels(path, scene);
        result_.enclosure = result_.enclosure == scene.enclosure ? scene.enclosure : Enclosure::automatic;
        result_.up = result_.up == scene.up ? scene.up : UpAxis::z;
        result_.camera = result_.camera ? result_.camera : scene.camera;
        const auto first_material = static_cast<std::uint32_t>(result_.materials.size());
        const auto first_group = static_cast<std::uint32_t>(result_.groups.size());
        for (Material& material : scene.materials) {
            result_.materials.push_back(std::move(material));
        }
        for (const std::string& group : scene.groups) {
            result_.groups.push_back(scene.groups.size() == 1 ? name : name + "/" + group);
            exported_.push_back(extension_of(path) == ".gltf" || extension_of(path) == ".glb");
        }
        for (Surface& surface : scene.surfaces) {
            surface.material += first_material;
            surface.group += first_group;
            result_.surfaces.push_back(surface);
        }
    }

    /// For every group, whether it is of a file whose sides may be an exporter's habit.
    [[nodiscard]] const std::vector<bool>& exported() const { return exported_; }

    [[nodiscard]] Scene finish() {
        result_.name = fmt::format("{}", fmt::join(names_, " + "));
        result_.environment.assign(result_.channels.size(), 0.0);
        return std::move(result_);
    }

private:
    static void widen(std::vector<Material>& materials, std::size_t channels) {
        for (Material& material : materials) {
            material.reflectance.assign(channels, material.reflectance.front());
            material.exitance.assign(channels, material.exitance.front());
        }
    }

    /// Values of one channel are those of all channels of the others.
    void take_channels(const std::filesystem::path& path, Scene& scene) {
        if (scene.channels == result_.channels) {
            return;
        }
        if (scene.channels.size() == 1) {
            widen(scene.materials, result_.channels.size());
        } else if (result_.channels.size() == 1) {
            widen(result_.materials, scene.channels.size());
            result_.channels = scene.channels;
        } else {
            throw InputError(fmt::format("{}: channels {}; the files before have {}", path.string(),
                                         fmt::join(scene.channels, ", "), fmt::join(result_.channels, ", ")));
        }
    }

    Scene result_;
    std::vector<std::string> names_;
    std::vector<bool> exported_;
};

} // namespace

Scene read_scenes(std::span<const std::filesystem::path> paths, const SceneReaderOptions& options,
                  Diagnostics& diagnostics) {
    if (paths.size() == 1) {
        return read_scene(paths.front(), options, diagnostics);
    }
    // Groups are turned by the names that they have together.
    SceneReaderOptions as_read = options;
    as_read.two_sided_groups.clear();
    as_read.one_sided_groups.clear();
    as_read.flipped_groups.clear();
    as_read.close_bodies = false;
    as_read.orientation = Orientation::as_read;
    as_read.symmetry = {};
    JoinedScenes joined;
    for (const std::filesystem::path& path : paths) {
        if (extension_of(path) == ".json") {
            throw InvalidArgument(fmt::format("{}: a JSON scene is read alone; it can name meshes itself "
                                              "(\"mesh\")",
                                              path.string()));
        }
        joined.add(path, read_scene(path, as_read, diagnostics));
    }
    Scene scene = joined.finish();
    scene.unit = options.unit;
    set_sides(scene, options, scene.name, diagnostics, joined.exported());
    set_symmetry(scene, options.symmetry);
    validate(scene);
    return scene;
}

} // namespace hemi::io
