#include "hemi/io/paths.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/daylight.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/picture.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/work.hpp"

#include <algorithm>
#include <array>

namespace hemi::python {

namespace {

using Point = std::array<double, 3>;

Vec3 vector(const Point& point) {
    return {point[0], point[1], point[2]};
}

/// An array of N·channels as one of [N, channels].
py::object by_channel(const py::object& self, const std::vector<double>& values) {
    const Solution& solution = py::cast<const SolutionOfScene&>(self).solution;
    if (values.empty()) {
        return py::none();
    }
    const auto channels = static_cast<py::ssize_t>(solution.channels);
    return view<double>(values, {static_cast<py::ssize_t>(values.size()) / channels, channels}, self);
}

const PatchedScene& scene_of(const SolutionOfScene& self) {
    if (!self.scene) {
        throw InvalidArgument(
            "the geometry of this solution is not known; load the form factors with their scene");
    }
    return *self.scene;
}

std::vector<std::string> channels_of(const SolutionOfScene& self) {
    if (self.scene && self.scene->scene.channels.size() == self.solution.channels) {
        return self.scene->scene.channels;
    }
    std::vector<std::string> names;
    for (std::uint32_t c = 0; c < self.solution.channels; ++c) {
        names.push_back(std::to_string(c));
    }
    return names;
}

/// Values that were given, where they were, and else the scene's, in as many channels as any of them have.
PatchValues given_values(const FactorsOfScene& factors, const py::object& reflectance,
                         const py::object& exitance, const py::object& environment) {
    std::optional<PatchValues> own;
    if (factors.scene) {
        own = patch_values(factors.scene->scene, factors.scene->mesh);
    } else if (reflectance.is_none() || exitance.is_none()) {
        throw InvalidArgument("reflectance and exitance: must be given, since the scene is not known");
    }
    const std::size_t size = factors.factors.matrix.size();
    const auto own_array = [&](const std::vector<double>& values) {
        return py::array_t<double>({size, std::size_t{own->channels}}, values.data());
    };
    const ChannelValues rho(reflectance.is_none() ? own_array(own->reflectance) : reflectance, "reflectance");
    const ChannelValues radiated(exitance.is_none() ? own_array(own->exitance) : exitance, "exitance");
    // One axis of the environment's are channels.
    py::object dark = py::float_(0.0);
    py::object behind = !environment.is_none() ? environment
                        : own && !own->environment.empty()
                            ? py::object(py::array_t<double>(
                                  static_cast<py::ssize_t>(own->environment.size()), own->environment.data()))
                            : dark;
    const py::object row = py::module_::import("numpy").attr("atleast_2d")(behind);
    const ChannelValues light(row, "environment");
    const std::size_t channels = std::max({rho.channels(), radiated.channels(), light.channels()});
    PatchValues values;
    values.channels = static_cast<std::uint32_t>(channels);
    values.reflectance = rho.spread(size, channels, "patches");
    values.exitance = radiated.spread(size, channels, "patches");
    values.environment = light.spread(1, channels, "environment");
    if (factors.scene && channels == factors.scene->scene.channels.size()) {
        values.sun = factors.scene->scene.sun;
        values.sky = factors.scene->scene.sky;
        values.up = factors.scene->scene.up;
        values.direct = direct_irradiance(factors.scene->scene, factors.scene->mesh, factors.factors.matrix);
    }
    return values;
}

io::ResultFile result_file(const PatchedScene& scene, const Solution& solution) {
    return {scene.scene, scene.subdivision, solution, scene.surfaces_as_read, scene.parts};
}

void save(const SolutionOfScene& self, const py::object& path) {
    const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
    const std::string extension = io::extension_of(file);
    const PatchedScene& scene = scene_of(self);
    const Solution& solution = self.solution;
    run([&] {
        if (extension == ".csv") {
            io::ResultFile result = result_file(scene, solution);
            result.scene.channels = channels_of(self);
            io::write_radiosity_csv(file, result);
            return;
        }
        if (extension != ".hres" && extension != ".vtp") {
            throw InvalidArgument(fmt::format("{}: solutions are written as .hres, .csv or .vtp", file));
        }
        if (!self.scene_values) {
            throw InvalidArgument(
                fmt::format("{}: holds the materials of the scene, but this is a solution for "
                            "other values; write a .csv",
                            file));
        }
        if (extension == ".hres") {
            io::write_hres(file, result_file(scene, solution));
        } else {
            io::write_vtp(file, scene.mesh, io::solution_arrays(result_file(scene, solution), scene.mesh));
        }
    });
}

std::optional<std::array<std::uint32_t, 3>> shown_channels(const std::vector<std::string>& channels,
                                                           const std::vector<std::string>& show) {
    if (show.empty()) {
        return std::nullopt;
    }
    if (show.size() != 1 && show.size() != 3) {
        throw InvalidArgument(fmt::format("show: {} channels; must be one or three", show.size()));
    }
    std::array<std::uint32_t, 3> indices{};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::string& name = show[show.size() == 1 ? 0 : k];
        const auto found = std::find(channels.begin(), channels.end(), name);
        if (found == channels.end()) {
            throw InvalidArgument(fmt::format("show: there is no channel \"{}\"{}", name,
                                              did_you_mean_or_list(name, channels)));
        }
        indices[k] = static_cast<std::uint32_t>(found - channels.begin());
    }
    return indices;
}

py::array_t<std::uint8_t> draw(const SolutionOfScene& self, const py::object& path,
                               const std::array<std::uint32_t, 2>& size, std::uint32_t samples,
                               std::optional<double> exposure, const std::string& tone_mapping, bool flat,
                               bool outlines, bool backs, const std::optional<Point>& eye,
                               const std::optional<Point>& target, const std::optional<Point>& up,
                               std::optional<double> fov, bool orthographic,
                               const std::vector<std::string>& show, const std::string& device) {
    const PatchedScene& known = scene_of(self);
    DrawSettings settings;
    settings.picture.width = size[0];
    settings.picture.height = size[1];
    settings.picture.samples = samples;
    settings.picture.tone_mapping = argument_word<ToneMapping>("tone_mapping", tone_mapping);
    settings.picture.shading = flat ? Shading::flat : Shading::gouraud;
    settings.picture.outlines = outlines;
    settings.picture.backs = backs;
    settings.picture.exposure = exposure.value_or(1.0);
    settings.automatic_exposure = !exposure;
    settings.show = shown_channels(channels_of(self), show);
    settings.device = device;
    if (eye.has_value() != target.has_value()) {
        throw InvalidArgument("eye and target: must be given together");
    }
    DrawnPicture drawn = run([&] {
        Scene scene;
        scene.channels = channels_of(self);
        scene.camera = known.scene.camera;
        scene.up = known.scene.up;
        if (known.scene.channels.size() == scene.channels.size()) {
            scene.environment = known.scene.environment;
            scene.materials = known.scene.materials;
        }
        Camera camera = eye ? scene.camera.value_or(default_camera(known.mesh.bounds(), known.scene.up))
                            : scene_camera(known.scene, known.mesh);
        camera.eye = eye ? vector(*eye) : camera.eye;
        camera.target = target ? vector(*target) : camera.target;
        camera.up = up ? vector(*up) : camera.up;
        camera.fov = fov.value_or(camera.fov);
        camera.orthographic = orthographic || (camera.orthographic && !eye);
        settings.camera = camera;
        DrawnPicture picture = draw_solution(scene, known.mesh, self.solution, settings);
        return picture;
    });
    if (!path.is_none()) {
        const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
        run([&] { write_picture(file, drawn.picture); });
    }
    return owned(std::move(drawn.picture.srgb), {drawn.picture.height, drawn.picture.width, 3});
}

py::object errors_of(const SolutionOfScene& self) {
    const auto error = solution_error(self.solution);
    if (!error) {
        return py::none();
    }
    const auto field = [](const FieldError& of) {
        return py::dict(py::arg("rms") = of.rms, py::arg("p95") = of.percentile95);
    };
    const std::size_t groups = error->groups.size();
    return py::dict(
        py::arg("vertices") = field(error->vertices), py::arg("field") = field(error->field),
        py::arg("groups") = owned(std::vector<double>(error->groups), {static_cast<py::ssize_t>(groups)}),
        py::arg("parts") = py::dict(py::arg("patch_size") = error->patch_size,
                                    py::arg("factors") = error->factors, py::arg("solver") = error->solver));
}

} // namespace

SolutionOfScene solve(const FactorsOfScene& factors, const py::object& reflectance,
                      const py::object& exitance, const py::object& environment, const std::string& method,
                      double tolerance, bool irradiance, bool estimate, const std::string& gather,
                      const py::object& progress) {
    SolutionOfScene result;
    result.scene = factors.scene;
    result.scene_values =
        factors.scene && reflectance.is_none() && exitance.is_none() && environment.is_none();
    SolverSettings settings;
    settings.method = argument_word<SolverMethod>("method", method);
    settings.tolerance = tolerance;
    const auto wanted = argument_word<Gather>("gather", gather);
    if (wanted == Gather::on && !factors.scene) {
        throw InvalidArgument("gather: the geometry is not known; load the form factors with their scene");
    }
    const PatchValues values = given_values(factors, reflectance, exitance, environment);
    PythonObserver observer(progress);
    result.solution = run([&] {
        Solution solution = solve_radiosity(factors.factors, values, settings, observer, irradiance);
        if (factors.scene) {
            gather_at_vertices(factors.scene->mesh, values, factors.factors.enclosure, factors.settings,
                               wanted, solution, observer);
        }
        if (estimate && result.scene_values && solution.error) {
            solution.patch_size_error =
                try_estimate_patch_size_error(factors.scene->scene, factors.scene->mesh, factors.factors,
                                              solution, factors.settings, observer);
        }
        return solution;
    });
    return result;
}

SolutionOfScene read_solution(const std::string& path) {
    return run([&] {
        io::ResultFile file = io::read_hres(path);
        io::complete_solution(file, PatchMesh(file.scene, file.subdivision));
        SolutionOfScene result;
        const auto scene = std::make_shared<PatchedScene>(std::move(file.scene), file.subdivision);
        scene->surfaces_as_read = std::move(file.surfaces_as_read);
        scene->parts = std::move(file.parts);
        result.scene = scene;
        result.solution = std::move(file.solution);
        return result;
    });
}

void bind_solution(py::module_& module) {
    py::class_<SolutionOfScene> type(module, "Solution", R"(
The radiosity of all patches, W/m² or lm/m². Arrays have the shape [N, channels] and are read-only.
)");
    const auto property = [&type](const char* name, auto getter, const char* text) {
        type.def_property_readonly(name, getter, text);
    };
    const auto channel_property = [&type](const char* name, std::vector<double> Solution::*values,
                                          const char* text) {
        type.def_property_readonly(
            name,
            [values](const py::object& self) {
                return by_channel(self, py::cast<const SolutionOfScene&>(self).solution.*values);
            },
            text);
    };
    const auto share_property = [&type](const char* name, std::vector<double> Solution::*values,
                                        const char* text) {
        type.def_property_readonly(
            name,
            [values](const py::object& self) {
                return view<double>(py::cast<const SolutionOfScene&>(self).solution.*values, self);
            },
            text);
    };
    channel_property("radiosity", &Solution::radiosity, "ndarray, [N, channels] : what leaves a patch.");
    channel_property("exitance", &Solution::exitance,
                     "ndarray, [N, channels] : what a patch radiates by itself.");
    channel_property(
        "irradiance", &Solution::irradiance,
        "ndarray, [N, channels], or None : what arrives at a patch; None where it was not asked for.");
    channel_property(
        "direct", &Solution::direct,
        "ndarray, [N, channels], or None : of what arrives, what comes straight from sun and sky; "
        "None without them.");
    share_property("row_sums", &Solution::row_sum, "ndarray, [N] : sum_j F(i, j).");
    share_property("environment", &Solution::environment_share,
                   "ndarray, [N] : share of what leaves a patch that meets no surface.");
    share_property("back_faces", &Solution::back_face_share,
                   "ndarray, [N] : share that meets the backs of one-sided surfaces.");
    property(
        "scene", [](const SolutionOfScene& self) { return self.scene; },
        "Scene or None : the patches; None where form factors were read without a scene.");
    property("channels", &channels_of, "list of str : names of the channels.");
    property(
        "method", [](const SolutionOfScene& self) { return std::string(to_word(self.solution.method)); },
        "str : solver that was used.");
    property(
        "sweeps", [](const SolutionOfScene& self) { return self.solution.sweeps; },
        "int : sweeps over the rows, or iterations.");
    property(
        "residual", [](const SolutionOfScene& self) { return self.solution.residual; },
        "float : relative residual, of the worst channel.");
    property(
        "error",
        [](const SolutionOfScene& self) {
            return self.solution.error ? std::optional(self.solution.error->rms) : std::nullopt;
        },
        "float or None : estimated error, rms, relative to what is reflected, from the form factors alone.");
    property("errors", &errors_of, R"(dict or None : estimated errors of the reflected light, all parts.

"vertices" (values interpolated between the patches' corners) and "field" (one value a patch), each with "rms" and
"p95", what 95 % of the area stays below, over the rms of what is reflected; "groups", ndarray: of the mean
irradiance of every group, relative to it, nan where that is dark; "parts" of vertices' rms: "patch_size", "factors"
and "solver". None where it was not estimated.)");
    property(
        "vertex_radiosity",
        [](const py::object& self) {
            const Solution& solution = py::cast<const SolutionOfScene&>(self).solution;
            if (solution.vertex_radiosity.empty()) {
                return py::object(py::none());
            }
            const auto channels = static_cast<py::ssize_t>(solution.channels);
            const auto patches = static_cast<py::ssize_t>(solution.vertex_radiosity.size()) / (4 * channels);
            return py::object(view<float>(solution.vertex_radiosity, {patches, 4, channels}, self));
        },
        R"(ndarray, [N, 4, channels], or None : radiosity at the corners of every patch, as the scene's `corners` has
them (the fourth of triangles means nothing), by rows of their own. None where it was not gathered.)");
    property(
        "patch_errors",
        [](const py::object& self) {
            const SolutionOfScene& solution = py::cast<const SolutionOfScene&>(self);
            if (!solution.solution.error) {
                return py::object(py::none());
            }
            return py::object(owned(
                radiosity_errors(solution.solution),
                {static_cast<py::ssize_t>(solution.solution.radiosity.size() / solution.solution.channels),
                 static_cast<py::ssize_t>(solution.solution.channels)}));
        },
        "ndarray, [N, channels], or None : estimated error of every radiosity, absolute.");
    type.def("__len__", [](const SolutionOfScene& self) {
        return self.solution.radiosity.size() / self.solution.channels;
    });
    type.def("__repr__", [](const SolutionOfScene& self) {
        return fmt::format("<hemi.Solution of {} patches, residual {:.2g}>",
                           self.solution.radiosity.size() / self.solution.channels, self.solution.residual);
    });
    type.def("save", &save, py::arg("path"), R"(
Writes a file by its extension: .hres (all of it, for load(), `hemi render` and `hemi view`), .csv (a line a
patch) or .vtp (ParaView).

Raises
------
InvalidArgument
    Another extension; a .hres or .vtp of a solution for other values than the scene's.
IoError
    The file cannot be written.
)");
    type.def("draw", &draw, py::arg("path") = py::none(), py::kw_only(),
             py::arg("size") = std::array<std::uint32_t, 2>{800, 800}, py::arg("samples") = 4,
             py::arg("exposure") = py::none(), py::arg("tone_mapping") = "filmic", py::arg("flat") = false,
             py::arg("outlines") = false, py::arg("backs") = false, py::arg("eye") = py::none(),
             py::arg("target") = py::none(), py::arg("up") = py::none(), py::arg("fov") = py::none(),
             py::arg("orthographic") = false, py::arg("show") = std::vector<std::string>(),
             py::arg("device") = "auto", R"(
Draws a picture of the radiosity.

Parameters
----------
path : path-like, optional
    File to write: .png, or .hdr for the radiosity itself.
size : (int, int)
    Width and height, pixels.
samples : int
    Supersamples along each edge of a pixel, 1 to 8.
exposure : float, optional
    Factor on the radiosity; without it chosen to suit the scene.
tone_mapping : {"filmic", "linear"}
    How brightness becomes a colour.
flat, outlines, backs : bool
    Every patch in one colour; outlines of patches; backs of one-sided surfaces are shown.
eye, target, up : sequence of float, 3 each, optional
    Camera: position, what is in the middle, upward direction. Without them the scene's camera, or one inside
    a room.
fov : float, optional
    Vertical field of view, degrees.
orthographic : bool
    Parallel rays.
show : sequence of str
    One channel, or three as red, green and blue; needed where there are neither one nor three.
device : str
    As of form_factors().

Returns
-------
ndarray of uint8, [height, width, 3]
    sRGB, rows from the top.

Raises
------
InvalidArgument
    A setting out of range.
NoDevice, GlError, IoError
    As their names say.
)");
}

} // namespace hemi::python
