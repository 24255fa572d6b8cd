#include "hemi/engine/baselines.hpp"
#include "hemi/io/paths.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/imprint.hpp"
#include "hemi/scene/thermal_exitance.hpp"
#include "hemi/scene/triangle_pairs.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/work.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace hemi::python {

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Indices = std::array<std::int64_t, 4>;

std::vector<Vec3> read_vertices(const Doubles& vertices) {
    if (vertices.ndim() != 2 || vertices.shape(1) != 3) {
        throw InvalidArgument("vertices: must have the shape [n, 3]");
    }
    const auto at = vertices.unchecked<2>();
    std::vector<Vec3> points;
    points.reserve(static_cast<std::size_t>(at.shape(0)));
    for (py::ssize_t i = 0; i < at.shape(0); ++i) {
        points.emplace_back(at(i, 0), at(i, 1), at(i, 2));
    }
    return points;
}

std::vector<Indices> face_array(const py::array& faces) {
    const char kind = faces.dtype().kind();
    if ((kind != 'i' && kind != 'u') || faces.ndim() != 2 || (faces.shape(1) != 3 && faces.shape(1) != 4)) {
        throw InvalidArgument(
            "faces: must be integers of the shape [m, 3] or [m, 4], or a list of lists of 3 or "
            "4 integers");
    }
    const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> converted(faces);
    const auto at = converted.unchecked<2>();
    std::vector<Indices> result;
    result.reserve(static_cast<std::size_t>(at.shape(0)));
    for (py::ssize_t f = 0; f < at.shape(0); ++f) {
        result.push_back({at(f, 0), at(f, 1), at(f, 2), at.shape(1) == 4 ? at(f, 3) : -1});
    }
    return result;
}

std::vector<Indices> face_list(const py::sequence& faces) {
    std::vector<Indices> result;
    for (const py::handle face : faces) {
        const auto indices = py::cast<std::vector<std::int64_t>>(face);
        if (indices.size() != 3 && indices.size() != 4) {
            throw InvalidArgument(
                fmt::format("faces[{}]: {} vertices; must be 3 or 4", result.size(), indices.size()));
        }
        result.push_back({indices[0], indices[1], indices[2], indices.size() == 4 ? indices[3] : -1});
    }
    return result;
}

Surface make_surface(const Indices& indices, std::size_t face, std::span<const Vec3> vertices) {
    Surface surface;
    surface.vertex_count = indices[3] == -1 ? 3 : 4;
    for (std::size_t k = 0; k < surface.vertex_count; ++k) {
        const std::int64_t index = indices[k];
        if (index < 0 || index >= static_cast<std::int64_t>(vertices.size())) {
            throw InvalidArgument(fmt::format("faces[{}]: vertex {}; there are {}, counted from 0", face,
                                              index, vertices.size()));
        }
        surface.vertices[k] = vertices[static_cast<std::size_t>(index)];
    }
    return surface;
}

std::vector<std::string> channel_names(const std::optional<std::vector<std::string>>& given,
                                       std::size_t channels) {
    if (given) {
        return *given;
    }
    if (channels == 1) {
        return {"grey"};
    }
    if (channels == 3) {
        return {"red", "green", "blue"};
    }
    std::vector<std::string> names;
    for (std::size_t c = 0; c < channels; ++c) {
        names.push_back(std::to_string(c));
    }
    return names;
}

/// Gives every face a material; equal ones are one.
void set_materials(Scene& scene, std::span<const double> reflectance, std::span<const double> exitance) {
    const std::size_t channels = scene.channels.size();
    std::map<std::pair<std::vector<double>, std::vector<double>>, std::uint32_t> known;
    for (std::size_t f = 0; f < scene.surfaces.size(); ++f) {
        const auto rho = reflectance.subspan(f * channels, channels);
        const auto own = exitance.subspan(f * channels, channels);
        const auto [found, is_new] = known.try_emplace({{rho.begin(), rho.end()}, {own.begin(), own.end()}},
                                                       static_cast<std::uint32_t>(scene.materials.size()));
        if (is_new) {
            scene.materials.push_back(
                {fmt::format("material {}", found->second), found->first.first, found->first.second});
        }
        scene.surfaces[f].material = found->second;
    }
}

void set_groups(Scene& scene, const py::object& groups) {
    if (groups.is_none() || py::isinstance<py::str>(groups)) {
        scene.groups = {groups.is_none() ? "default" : py::cast<std::string>(groups)};
        return;
    }
    const auto names = py::cast<std::vector<std::string>>(groups);
    if (names.size() != scene.surfaces.size()) {
        throw InvalidArgument(fmt::format("groups: {} names; must be one for each of the {} faces",
                                          names.size(), scene.surfaces.size()));
    }
    std::unordered_map<std::string, std::uint32_t> known;
    for (std::size_t f = 0; f < names.size(); ++f) {
        const auto [found, is_new] =
            known.try_emplace(names[f], static_cast<std::uint32_t>(scene.groups.size()));
        if (is_new) {
            scene.groups.push_back(names[f]);
        }
        scene.surfaces[f].group = found->second;
    }
}

void set_two_sided(Scene& scene, const py::object& two_sided) {
    const auto flags = py::array_t<bool>::ensure(two_sided);
    const auto faces = static_cast<py::ssize_t>(scene.surfaces.size());
    if (!flags || flags.ndim() > 1 || (flags.ndim() == 1 && flags.shape(0) != faces)) {
        throw InvalidArgument(
            fmt::format("two_sided: must be True, False or one of these for each of the {} faces",
                        scene.surfaces.size()));
    }
    for (py::ssize_t f = 0; f < faces; ++f) {
        scene.surfaces[static_cast<std::size_t>(f)].two_sided =
            flags.ndim() == 0 ? *flags.data() : flags.at(f);
    }
}

void set_environment(Scene& scene, const py::object& environment) {
    const std::size_t channels = scene.channels.size();
    const auto values = Doubles::ensure(environment);
    if (!values || values.ndim() > 1 ||
        (values.ndim() == 1 && values.shape(0) != static_cast<py::ssize_t>(channels))) {
        throw InvalidArgument(
            fmt::format("environment: must be a number or one for each of the {} channels", channels));
    }
    scene.environment.clear();
    for (std::size_t c = 0; c < channels; ++c) {
        const double value = values.ndim() == 0 ? *values.data() : values.at(static_cast<py::ssize_t>(c));
        if (!(value >= 0.0) || !std::isfinite(value)) {
            throw InvalidArgument(fmt::format("environment {}; must be finite and not negative", value));
        }
        scene.environment.push_back(value);
    }
}

ScenePointer scene_from_arrays(const Doubles& vertices, const py::object& faces,
                               const py::object& reflectance, const py::object& exitance,
                               const py::object& groups, const py::object& two_sided,
                               const std::optional<std::vector<std::string>>& channels,
                               std::optional<double> patch_size,
                               std::optional<std::uint32_t> patches_per_face, const std::string& enclosure,
                               const py::object& environment, const std::string& name) {
    Scene scene;
    scene.name = name;
    const auto points = read_vertices(vertices);
    const auto indices =
        py::isinstance<py::array>(faces) ? face_array(faces) : face_list(py::cast<py::sequence>(faces));
    for (std::size_t f = 0; f < indices.size(); ++f) {
        scene.surfaces.push_back(make_surface(indices[f], f, points));
    }
    const ChannelValues rho(reflectance, "reflectance");
    const ChannelValues own(exitance, "exitance");
    scene.channels = channel_names(channels, std::max(rho.channels(), own.channels()));
    set_materials(scene, rho.spread(indices.size(), scene.channels.size(), "faces"),
                  own.spread(indices.size(), scene.channels.size(), "faces"));
    set_groups(scene, groups);
    set_two_sided(scene, two_sided);
    set_environment(scene, environment);
    scene.enclosure = argument_word<Enclosure>("enclosure", enclosure);
    return run([&] {
        validate(scene);
        const Subdivision subdivision{patch_size, patches_per_face};
        join_triangle_pairs(scene, subdivision);
        return std::make_shared<PatchedScene>(std::move(scene), subdivision);
    });
}

ScenePointer read_scene(const py::object& path, std::optional<double> patch_size,
                        std::optional<std::uint32_t> patches_per_face,
                        const std::optional<std::string>& enclosure, const py::object& environment,
                        const std::vector<std::string>& two_sided, const std::vector<std::string>& one_sided,
                        const std::vector<std::string>& flip, const std::string& orient,
                        const std::string& zone, bool strict, double planarity, bool allow_outside,
                        bool with_imprint) {
    const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
    if (!two_sided.empty() && io::extension_of(file) == ".json") {
        throw InvalidArgument("two_sided is not for JSON scenes, which say \"two_sided\": true");
    }
    io::SceneReaderOptions options;
    options.two_sided_groups = two_sided;
    options.one_sided_groups = one_sided;
    options.flipped_groups = flip;
    options.orientation = argument_word<Orientation>("orient", orient);
    options.zone = zone;
    options.strict = strict;
    options.allow_outside = allow_outside;
    options.planarity = planarity;
    Diagnostics diagnostics;
    Scene scene = run([&] {
        Scene read = io::read_scene(file, options, diagnostics);
        radiate_by_temperature(read, diagnostics);
        return read;
    });
    warn(diagnostics);
    if (enclosure) {
        scene.enclosure = argument_word<Enclosure>("enclosure", *enclosure);
    }
    if (!environment.is_none()) {
        set_environment(scene, environment);
    }
    return run([&] {
        const Subdivision subdivision{patch_size, patches_per_face};
        join_triangle_pairs(scene, subdivision);
        std::optional<Imprint> cut = imprint(scene, subdivision, with_imprint);
        return cut ? std::make_shared<PatchedScene>(scene, subdivision, std::move(*cut))
                   : std::make_shared<PatchedScene>(std::move(scene), subdivision);
    });
}

py::array_t<double> corners(const PatchMesh& mesh) {
    std::vector<double> values;
    values.reserve(std::size_t{12} * mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners patch = mesh.corners(i);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Vec3& point = patch.points[std::min(k, patch.count - 1)];
            values.insert(values.end(), {point.x, point.y, point.z});
        }
    }
    return owned(std::move(values), {mesh.size(), 4, 3});
}

py::array_t<double> normals(const PatchMesh& mesh) {
    std::vector<double> values;
    values.reserve(std::size_t{3} * mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const Vec3 normal = mesh.normal(i);
        values.insert(values.end(), {normal.x, normal.y, normal.z});
    }
    return owned(std::move(values), {mesh.size(), 3});
}

py::array_t<std::uint32_t> group_of(const PatchMesh& mesh) {
    std::vector<std::uint32_t> groups;
    groups.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        groups.push_back(mesh.group(i));
    }
    return owned(std::move(groups));
}

py::array_t<double> values_of(const PatchedScene& scene, std::vector<double> Material::*property) {
    return owned(patch_values(scene.mesh, scene.scene.materials, property),
                 {scene.mesh.size(), static_cast<py::ssize_t>(scene.scene.channels.size())});
}

py::array_t<double> factors_of_point(const PatchedScene& scene, const std::array<double, 3>& point,
                                     const std::array<double, 3>& normal, bool occlusion) {
    const Vec3 direction(normal[0], normal[1], normal[2]);
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) {
        throw InvalidArgument("normal: must have a length");
    }
    return owned(run([&] {
        return point_factors(scene.mesh, Vec3(point[0], point[1], point[2]), direction / length, occlusion);
    }));
}

} // namespace

PatchedScene::PatchedScene(Scene the_scene, Subdivision the_subdivision)
    : scene(std::move(the_scene)), subdivision(the_subdivision), mesh(scene, subdivision) {}

PatchedScene::PatchedScene(const Scene& as_read, const Subdivision& the_subdivision, Imprint cut)
    : scene(std::move(cut.scene)), mesh(scene), face_of(std::move(cut.face_of)),
      surfaces_as_read(as_read.surfaces), parts(std::move(cut.parts)) {
    const PatchMesh patches(as_read, the_subdivision);
    for (std::uint32_t s = 0; s < surfaces_as_read.size(); ++s) {
        surfaces_as_read[s].patches = patches.grid(s);
    }
}

void bind_scene(py::module_& module) {
    py::class_<PatchedScene, std::shared_ptr<PatchedScene>> type(module, "Scene", R"(
Surfaces, their materials, and the patches that they are cut into. Never changes.

Patch i is row i and column i of all form factors. Order: faces as listed; patches of a face row by row; the
back of a two-sided face behind its front.

Parameters
----------
vertices : array_like of float, shape [n, 3]
    Scene units.
faces : array_like of int, shape [m, 3] or [m, 4], or list of lists
    Indices of vertices, counter-clockwise seen from the front, which emits and receives. In four columns, a
    last index of -1 makes a triangle; in a list, faces have 3 or 4 indices each. Planar and convex.
reflectance : array_like
    Share reflected, in [0, 1): a number, or of shape [m] (a value a face), [1, channels] (the same for all
    faces) or [m, channels].
exitance : array_like
    What faces radiate by themselves, W/m² or lm/m², of the same shapes.
groups : str or sequence of str, optional
    Name of every face's group; one name for all.
two_sided : bool or array_like of bool, shape [m]
    Faces that radiate and receive on their backs, too; the back of others blocks only.
channels : sequence of str, optional
    Names of the channels.
patch_size : float, optional
    Longest patch edge, scene units. Without it a face is one patch.
patches_per_face : int, optional
    About so many patches of each face.
enclosure : {"auto", "closed", "open"}
    Whether all that leaves a patch arrives at another.
environment : float or array_like, shape [channels]
    Exitance of what lies behind all surfaces (pi times its radiance).
name : str
    Its name.

Raises
------
InvalidArgument, InputError
    For shapes and values that do not fit, naming the face.
)");
    type.def(
        py::init([](const Doubles& vertices, const py::object& faces, const py::object& reflectance,
                    const py::object& exitance, const py::object& groups, const py::object& two_sided,
                    const std::optional<std::vector<std::string>>& channels, std::optional<double> patch_size,
                    std::optional<std::uint32_t> patches_per_face, const std::string& enclosure,
                    const py::object& environment, const std::string& name) {
            return scene_from_arrays(vertices, faces, reflectance, exitance, groups, two_sided, channels,
                                     patch_size, patches_per_face, enclosure, environment, name);
        }),
        py::arg("vertices"), py::arg("faces"), py::kw_only(), py::arg("reflectance") = 0.5,
        py::arg("exitance") = 0.0, py::arg("groups") = py::none(), py::arg("two_sided") = false,
        py::arg("channels") = py::none(), py::arg("patch_size") = py::none(),
        py::arg("patches_per_face") = py::none(), py::arg("enclosure") = "auto", py::arg("environment") = 0.0,
        py::arg("name") = "");
    type.def("__len__", [](const PatchedScene& scene) { return scene.mesh.size(); });
    type.def("__repr__", [](const PatchedScene& scene) {
        return fmt::format("<hemi.Scene of {} patches>", scene.mesh.size());
    });
    type.def_property_readonly(
        "name", [](const PatchedScene& scene) { return scene.scene.name; },
        "str : its own name, or the file's.");
    type.def_property_readonly(
        "channels", [](const PatchedScene& scene) { return scene.scene.channels; },
        "list of str : names of the channels.");
    type.def_property_readonly(
        "groups", [](const PatchedScene& scene) { return scene.scene.groups; },
        "list of str : names of the groups.");
    type.def_property_readonly(
        "enclosure", [](const PatchedScene& scene) { return std::string(to_word(scene.scene.enclosure)); },
        "str : \"auto\", \"closed\" or \"open\".");
    type.def_property_readonly(
        "environment",
        [](const PatchedScene& scene) {
            std::vector<double> values = scene.scene.environment;
            values.resize(scene.scene.channels.size(), 0.0);
            return owned(std::move(values));
        },
        "ndarray, [channels] : exitance of the environment.");
    type.def_property_readonly(
        "areas",
        [](const py::object& self) { return view(py::cast<const PatchedScene&>(self).mesh.areas(), self); },
        "ndarray, [N] : areas of the patches, scene units squared. Read-only.");
    type.def_property_readonly(
        "centres",
        [](const py::object& self) {
            const PatchMesh& mesh = py::cast<const PatchedScene&>(self).mesh;
            static_assert(sizeof(Vec3) == 3 * sizeof(double));
            return view<double>({&mesh.centres().data()->x, std::size_t{3} * mesh.size()}, {mesh.size(), 3},
                                self);
        },
        "ndarray, [N, 3] : area centroids of the patches. Read-only.");
    type.def_property_readonly(
        "normals", [](const PatchedScene& scene) { return normals(scene.mesh); },
        "ndarray, [N, 3] : unit normals, towards the side that a patch radiates to.");
    type.def_property_readonly(
        "corners", [](const PatchedScene& scene) { return corners(scene.mesh); },
        "ndarray, [N, 4, 3] : corners, counter-clockwise about the normal; the last one of "
        "a triangle is there twice.");
    type.def_property_readonly(
        "group_of", [](const PatchedScene& scene) { return group_of(scene.mesh); },
        "ndarray of uint32, [N] : index into groups.");
    type.def_property_readonly(
        "face_of",
        [](const PatchedScene& scene) {
            std::vector<std::uint32_t> faces(scene.mesh.surface_of().begin(), scene.mesh.surface_of().end());
            const std::vector<std::uint32_t> numbers =
                face_numbers(scene.face_of.empty() ? scene.scene.surfaces : scene.surfaces_as_read);
            for (std::uint32_t& face : faces) {
                face = numbers[scene.face_of.empty() ? face : scene.face_of[face]];
            }
            return owned(std::move(faces));
        },
        "ndarray of uint32, [N] : index of the face that a patch is part of, in the order of the file or the "
        "array.");
    type.def_property_readonly(
        "patch_of",
        [](const PatchedScene& scene) -> py::object {
            return scene.parts.any() ? py::object(owned(std::vector(scene.parts.patch_of))) : py::none();
        },
        "ndarray of uint32, [N], or None : where faces were cut because others touch them, or since they are "
        "not plane, not convex or of many corners, the patch of the scene as it was read that each patch is "
        "part of; FormFactors.by_patch() gives F of those.");
    type.def_property_readonly(
        "reflectance", [](const PatchedScene& scene) { return values_of(scene, &Material::reflectance); },
        "ndarray, [N, channels] : share that a patch reflects.");
    type.def_property_readonly(
        "exitance", [](const PatchedScene& scene) { return values_of(scene, &Material::exitance); },
        "ndarray, [N, channels] : what a patch radiates by itself, W/m² or lm/m².");

    module.def("read_scene", &read_scene, py::arg("path"), py::kw_only(), py::arg("patch_size") = py::none(),
               py::arg("patches_per_face") = py::none(), py::arg("enclosure") = py::none(),
               py::arg("environment") = py::none(), py::arg("two_sided") = std::vector<std::string>(),
               py::arg("one_sided") = std::vector<std::string>(),
               py::arg("flip") = std::vector<std::string>(), py::arg("orient") = "as-read",
               py::arg("zone") = "", py::arg("strict") = false, py::arg("planarity") = 1e-5,
               py::arg("allow_outside") = false, py::arg("imprint") = true, R"(
Reads a scene: .json, .obj, .gltf, .glb, .vs3, .epJSON, .msh, .inp, .bdf, .nas, .vtk, .vtp, .vtu, .ply or .stl, by its
extension.

Parameters
----------
path : path-like
    Of the file.
patch_size : float, optional
    Longest patch edge, scene units, instead of the scene's own.
patches_per_face : int, optional
    About so many patches of each face.
enclosure : {"auto", "closed", "open"}, optional
    Instead of what the scene says.
environment : float or array_like, shape [channels], optional
    Exitance of the environment instead of the scene's own.
two_sided : sequence of str
    Groups whose faces radiate on both sides, "*": all. JSON scenes say so themselves.
one_sided : sequence of str
    Groups of which only the front radiates, whatever the file says, "*": all.
flip : sequence of str
    Groups whose faces are turned round, "*": all.
orient : {"as-read", "in", "out"}
    Turn the faces of every watertight body inwards or outwards.
zone : str
    The zone of an .epJSON file that is the scene; needed where it has several.
strict : bool
    Refuse faces without area or out of plane, instead of leaving those out and cutting these, with a HemiWarning.
planarity : float
    How far corners of a face may be off its plane, as a share of its longest edge, before it is cut.
allow_outside : bool
    Open files outside the scene's folder that the scene names.
imprint : bool
    Cut faces where others stand on them, lie on them or pass through them, and leave out what is covered. The
    patches are then parts of those of the faces: see Scene.patch_of and Scene.face_of.

Returns
-------
Scene

Raises
------
InputError
    ParseError among them: with file, place, value and what would be right.
InvalidArgument
    A group of two_sided that is not there.
)");
    module.def("point_factors", &factors_of_point, py::arg("scene"), py::arg("point"), py::arg("normal"),
               py::kw_only(), py::arg("occlusion") = true, R"(
Factors from a surface element to every patch.

Parameters
----------
scene : Scene
    Its patches.
point, normal : sequence of float, 3 each
    Where the element is and what it faces; the normal may have any length.
occlusion : bool
    Whether surfaces hide others.

Returns
-------
ndarray, [N]
    Share of what leaves the element that arrives at each patch.
)");
}

} // namespace hemi::python
