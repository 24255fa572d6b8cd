#include "hemi/io/factor_file.hpp"
#include "hemi/io/paths.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/expansion.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/diagnosis.hpp"
#include "python/matrix_arrays.hpp"
#include "python/work.hpp"

#include <algorithm>

namespace hemi::python {

namespace {

using FactorsPointer = std::shared_ptr<FactorsOfScene>;

/// hemi.Row: shows a row of its owner.
struct Row {
    py::object owner;
    std::uint32_t size;
    RowView view;
};

/// Refuses what does not apply, so that it is not silently left out.
void refuse_unless(bool given, bool applies, const char* argument, const std::string& method,
                   const char* methods) {
    if (given && !applies) {
        throw InvalidArgument(
            fmt::format("{} does not apply to method \"{}\"; it belongs to {}", argument, method, methods));
    }
}

void check_settings(const FactorSettings& settings) {
    const std::string method(to_word(settings.method));
    const bool hemicube = settings.method == Method::hemicube;
    const bool montecarlo = settings.method == Method::montecarlo;
    const bool hemisphere = settings.method == Method::hemisphere;
    refuse_unless(settings.preset != Preset::standard, hemicube, "preset", method, "hemicube");
    refuse_unless(settings.eye_points.has_value(), hemicube, "eye_points", method, "hemicube");
    refuse_unless(settings.shadow_rays.has_value(), hemicube, "shadow_rays", method, "hemicube");
    refuse_unless(settings.resolution.has_value(), hemicube || hemisphere, "resolution", method,
                  "hemicube, hemisphere");
    refuse_unless(settings.rays.has_value(), montecarlo, "rays", method, "montecarlo");
    refuse_unless(settings.seed.has_value(), hemicube || montecarlo || hemisphere, "seed", method,
                  "hemicube, montecarlo, hemisphere");
    if (settings.shadow_rays && settings.preset == Preset::plain) {
        throw InvalidArgument("shadow_rays does not apply to preset \"plain\", which has no visibilities; it "
                              "belongs to fast, default, exact");
    }
    if (settings.shadow_rays.value_or(0) > 4096) {
        throw InvalidArgument(fmt::format("shadow_rays {}; must be 0 to 4096", *settings.shadow_rays));
    }
}

std::vector<std::uint32_t> checked_patches(const std::vector<std::int64_t>& given, std::uint32_t size) {
    std::vector<std::uint32_t> patches;
    for (const std::int64_t patch : given) {
        if (patch < 0 || patch >= size) {
            throw InvalidArgument(fmt::format("patches: {}; the scene has {}, counted from 0", patch, size));
        }
        patches.push_back(static_cast<std::uint32_t>(patch));
    }
    std::sort(patches.begin(), patches.end());
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    return patches;
}

std::optional<Repair> repair_argument(const std::optional<std::string>& word) {
    return word ? std::optional(argument_word<Repair>("repair", *word)) : std::nullopt;
}

/// Prepares raw form factors, and keeps them as they are, too: a `.hff` holds raw rows.
FactorsPointer prepared(ScenePointer scene, FormFactors raw, const FactorSettings& settings,
                        Observer& observer = no_observer()) {
    auto result = std::make_shared<FactorsOfScene>();
    result->settings = settings;
    const PatchParts scene_parts = scene ? scene->parts : PatchParts();
    result->scene = std::move(scene);
    if (scene_parts.any()) {
        raw.parts = scene_parts;
    }
    result->factors = raw;
    result->raw = std::move(raw);
    prepare_form_factors(result->factors, settings.repair, observer);
    result->factors.matrix = expand_clusters(result->factors.matrix, memory_limit(settings));
    return result;
}

FactorsPointer
form_factors(const ScenePointer& scene, const std::string& preset, std::optional<std::uint32_t> resolution,
             std::optional<std::uint32_t> eye_points, std::optional<std::uint32_t> shadow_rays,
             const std::string& method, std::optional<std::uint32_t> rays, std::optional<std::uint64_t> seed,
             const std::string& device, std::uint32_t jobs, const std::optional<std::string>& repair,
             std::optional<bool> estimate, std::optional<std::uint64_t> max_memory,
             const std::optional<std::vector<std::int64_t>>& patches, const py::object& progress) {
    FactorSettings settings;
    settings.preset = argument_word<Preset>("preset", preset);
    settings.method = argument_word<Method>("method", method);
    settings.resolution = resolution;
    settings.eye_points = eye_points;
    settings.shadow_rays = shadow_rays;
    settings.rays = rays;
    settings.seed = seed;
    settings.max_memory = max_memory;
    settings.engine.device = device;
    settings.engine.jobs = jobs;
    settings.repair = repair_argument(repair);
    settings.estimate_error = estimate.value_or(!patches);
    check_settings(settings);
    const std::uint32_t size = scene->mesh.size();
    const auto wanted = patches ? checked_patches(*patches, size) : all_patches(size);
    if (patches && !settings.repair) {
        settings.repair = Repair::none; // closure needs the rows of both patches of a pair
    }
    PythonObserver observer(progress);
    return run([&] {
        return prepared(scene,
                        compute_raw_form_factors(scene->scene, scene->mesh, wanted, settings, observer),
                        settings, observer);
    });
}

/// Rows that a file with F alone has are known to belong to the scene by their number only.
void describe_by_scene(FormFactors& factors, const PatchedScene& scene, const std::string& path) {
    const PatchMesh& mesh = scene.mesh;
    if (factors.matrix.size() != mesh.size()) {
        throw InputError(fmt::format("{}: form factors of {} patches; the scene has {}", path,
                                     factors.matrix.size(), mesh.size()));
    }
    factors.areas.assign(mesh.areas().begin(), mesh.areas().end());
    factors.groups = mesh.groups();
    factors.group_of.clear();
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        factors.group_of.push_back(mesh.group(i));
    }
    factors.geometry_hash = mesh.geometry_hash();
}

FactorsPointer read_form_factors_of(const std::string& path, const ScenePointer& scene,
                                    std::optional<Repair> wanted) {
    if (io::extension_of(path) == ".hff") {
        FactorSettings settings;
        settings.repair = wanted;
        return prepared(
            scene, scene ? read_form_factors(path, scene->scene, scene->mesh) : io::read_hff(path), settings);
    }
    if (wanted) {
        throw InvalidArgument(
            fmt::format("repair applies to .hff, which holds raw rows; those of {} are as they "
                        "were written",
                        path));
    }
    auto result = std::make_shared<FactorsOfScene>();
    result->scene = scene;
    result->factors = io::read_factors(path);
    result->factors.work.from_file = true;
    if (scene) {
        describe_by_scene(result->factors, *scene, path);
    }
    return result;
}

py::object load(const py::object& path, const ScenePointer& scene, const std::optional<std::string>& repair) {
    const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
    const auto wanted = repair_argument(repair);
    if (io::extension_of(file) == ".hres") {
        if (scene || wanted) {
            throw InvalidArgument(
                fmt::format("{}: a solution has a scene of its own; leave out scene and repair", file));
        }
        return py::cast(read_solution(file));
    }
    return py::cast(run([&] { return read_form_factors_of(file, scene, wanted); }));
}

void save(FactorsOfScene& self, const py::object& path, const std::string& zone) {
    const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
    const std::string extension = io::extension_of(file);
    Diagnostics diagnostics;
    run([&] {
        if (!zone.empty() && extension != ".idf") {
            throw InvalidArgument(fmt::format("zone: is for EnergyPlus' .idf, and the file is {}", file));
        }
        if (extension == ".vtp") {
            if (!self.scene) {
                throw InvalidArgument(
                    fmt::format("{}: needs the geometry; load the form factors with their scene", file));
            }
            io::write_vtp(file, self.scene->mesh, io::factor_arrays(self.factors));
        } else if (extension == ".hff") {
            if (!self.raw) {
                throw InvalidArgument(
                    fmt::format("{}: holds rows as they were computed, which are not known of "
                                "form factors of patches, or from a file of another kind",
                                file));
            }
            estimate_error(*self.raw);
            io::write_hff(file, *self.raw);
        } else {
            const std::vector<double> emissivity =
                self.scene ? emissivities(self.scene->mesh, self.scene->scene.materials)
                           : std::vector<double>{};
            io::write_factors(file, self.factors, {emissivity, zone}, diagnostics);
        }
    });
    warn(diagnostics);
}

py::object matrix_of(FactorsOfScene& self) {
    if (!self.csr) {
        self.csr = csr_matrix(self.factors.matrix);
    }
    return *self.csr;
}

py::object visibility_of(FactorsOfScene& self) {
    if (!self.visibility) {
        self.visibility = visibility_codes(self.factors.matrix);
    }
    return *self.visibility;
}

Row row_of(const py::object& self, std::int64_t index) {
    const FormFactorMatrix& matrix = py::cast<const FactorsOfScene&>(self).factors.matrix;
    if (index < 0 || index >= matrix.size()) {
        throw py::index_error(fmt::format("row {}: there are {}, counted from 0", index, matrix.size()));
    }
    const auto i = static_cast<std::uint32_t>(index);
    if (!matrix.known(i)) {
        throw InvalidArgument(fmt::format("row {} was not computed", index));
    }
    return {self, matrix.size(), matrix.row(i)};
}

py::array_t<double> dense(const Row& row) {
    std::vector<double> values(row.size);
    for (std::size_t k = 0; k < row.view.columns.size(); ++k) {
        values[row.view.columns[k]] = double{row.view.values[k]};
    }
    return owned(std::move(values));
}

py::dict by_group(const FormFactors& factors) {
    if (factors.groups.empty()) {
        throw InvalidArgument("the groups of these form factors are not known; load them with their scene");
    }
    const auto groups = static_cast<std::uint32_t>(factors.groups.size());
    GroupFactors sums = group_factors(factors.matrix, factors.areas, factors.group_of, groups);
    py::dict result;
    result["groups"] = factors.groups;
    result["areas"] = owned(std::move(sums.areas));
    result["factors"] = owned(std::move(sums.factors), {groups, groups});
    result["environment"] = owned(std::move(sums.environment));
    result["back_faces"] = owned(std::move(sums.blocked));
    return result;
}

py::dict settings_of(const FormFactors& factors) {
    const Provenance& made = factors.provenance;
    py::dict settings;
    settings["method"] = std::string(to_word(made.method));
    settings["preset"] = made.preset ? py::object(py::str(std::string(to_word(*made.preset)))) : py::none();
    settings["resolution"] = made.resolution;
    settings["eye_points"] = made.eye_points;
    settings["near_eye_points"] = made.near_eye_points;
    settings["shadow_rays"] = made.shadow_rays;
    settings["exchange_rule"] = std::string(to_word(made.exchange_rule));
    settings["seed"] = made.seed;
    settings["repair"] =
        factors.repair ? py::object(py::str(std::string(to_word(factors.repair->repair)))) : py::none();
    settings["renderer"] = made.renderer;
    return settings;
}

void bind_row(py::module_& module) {
    py::class_<Row> type(module, "Row", R"(
One row of F: where what leaves a patch goes. Sum, environment and back_faces add up to 1.
)");
    type.def_property_readonly(
        "columns", [](const Row& row) { return view(row.view.columns, row.owner); },
        "ndarray of uint32 : patches j with F(i, j) > 0, ascending. Read-only.");
    type.def_property_readonly(
        "values", [](const Row& row) { return view(row.view.values, row.owner); },
        "ndarray of float32 : F(i, j) of these. Read-only.");
    type.def_property_readonly(
        "visibility",
        [](const Row& row) {
            return row.view.visibility.empty() ? py::object(py::none())
                                               : py::object(view(row.view.visibility, row.owner));
        },
        "ndarray of uint8 or None : visibility of these in 255ths; None where it is not known. Read-only.");
    type.def_property_readonly(
        "sum", [](const Row& row) { return row.view.sum(); }, "float : sum of the values.");
    type.def_property_readonly(
        "environment", [](const Row& row) { return row.view.environment; },
        "float : share that meets no surface.");
    type.def_property_readonly(
        "back_faces", [](const Row& row) { return row.view.blocked; },
        "float : share that meets the backs of one-sided surfaces.");
    type.def("dense", &dense, R"(
Returns
-------
ndarray, [N]
    F(i, j) of all patches j, zeros included.
)");
    type.def("__len__", [](const Row& row) { return row.view.columns.size(); });
    type.def("__repr__", [](const Row& row) {
        return fmt::format("<hemi.Row of {} entries, sum {:.6f}>", row.view.columns.size(), row.view.sum());
    });
}

void bind_estimate(py::module_& module) {
    using Estimate = FactorErrorEstimate;
    py::class_<Estimate> type(module, "FactorError", R"(
Estimated error of form factors, judged by better rows of a sample.

The error of a row is the root of sum_j (F(i, j) - F*(i, j))², F* being the right ones.
)");
    type.def_readonly("sampled", &Estimate::sampled, "int : rows that were compared.");
    type.def_readonly("rms", &Estimate::rms, "float : of a factor, over the pairs that see each other.");
    type.def_readonly("max", &Estimate::max, "float : of a factor, over all pairs.");
    type.def_readonly("row_rms", &Estimate::row_rms, "float : of a row, over all rows.");
    type.def_readonly("row_max", &Estimate::row_max, "float : of a row, the largest.");
    type.def_property_readonly(
        "rows",
        [](const py::object& self) { return view<double>(py::cast<const Estimate&>(self).rows, self); },
        "ndarray, [N] : error of every row; 0 where it is unknown. Read-only.");
    type.def("__repr__", [](const Estimate& error) {
        return fmt::format("<hemi.FactorError: a row {:.3g} rms, {:.3g} at most; {} rows compared>",
                           error.row_rms, error.row_max, error.sampled);
    });
}

void bind_class(py::module_& module) {
    py::class_<FactorsOfScene, FactorsPointer> type(module, "FormFactors", R"(
Form factors F(i, j), the share of what leaves patch i that arrives at patch j, ready to be used.

Of every row, sum_j F(i, j) + environment[i] + back_faces[i] = 1. ``F @ x`` is the product with an array of
shape [N] or [N, channels], in double, without a copy of the matrix: ``F @ radiosity`` is the irradiance that
comes from patches. Memory: 9 bytes an entry, and as much again for the rows as they were computed, which
save() writes into a .hff; ``matrix`` takes 8 more.
)");
    const auto property = [&type](const char* name, auto getter, const char* text) {
        type.def_property_readonly(name, getter, text);
    };
    property("matrix", &matrix_of,
             R"(scipy.sparse.csr_matrix of float32, [N, N] : a copy, made on first use.)");
    property("visibility", &visibility_of,
             "ndarray of uint8 or None : visibility of every entry of matrix.data in 255ths, 255 where "
             "nothing was "
             "hidden; None where it is not known.");
    property(
        "shape",
        [](const FactorsOfScene& self) {
            return py::make_tuple(self.factors.matrix.size(), self.factors.matrix.size());
        },
        "tuple of int : (N, N).");
    property(
        "nnz", [](const FactorsOfScene& self) { return self.factors.matrix.entries(); },
        "int : stored entries.");
    property(
        "scene", [](const FactorsOfScene& self) { return self.scene; },
        "Scene or None : None where form factors were read without one.");
    property(
        "areas",
        [](const py::object& self) {
            return view<double>(py::cast<const FactorsOfScene&>(self).factors.areas, self);
        },
        "ndarray, [N] : areas of the patches; empty where a file does not have them. Read-only.");
    property(
        "groups", [](const FactorsOfScene& self) { return self.factors.groups; },
        "list of str : names of the groups.");
    property(
        "group_of",
        [](const py::object& self) {
            return view<std::uint32_t>(py::cast<const FactorsOfScene&>(self).factors.group_of, self);
        },
        "ndarray of uint32, [N] : index into groups. Read-only.");
    property(
        "environment",
        [](const FactorsOfScene& self) { return share_of_rows(self.factors.matrix, &RowBlock::environment); },
        "ndarray, [N] : share of what leaves a patch that meets no surface.");
    property(
        "back_faces",
        [](const FactorsOfScene& self) { return share_of_rows(self.factors.matrix, &RowBlock::blocked); },
        "ndarray, [N] : share that meets the backs of one-sided surfaces.");
    property(
        "row_sums", [](const FactorsOfScene& self) { return row_sums_of(self.factors.matrix); },
        "ndarray, [N] : sum_j F(i, j).");
    property(
        "known", [](const FactorsOfScene& self) { return known_rows(self.factors.matrix); },
        "ndarray of bool, [N] : rows that were computed; all others are empty.");
    property(
        "estimate", [](const FactorsOfScene& self) { return self.factors.error; },
        "FactorError or None : estimated error.");
    property(
        "settings", [](const FactorsOfScene& self) { return settings_of(self.factors); },
        "dict : what made the rows: method, preset, resolution, eye_points, near_eye_points, shadow_rays, "
        "exchange_rule, seed, repair, renderer.");
    type.def("row", &row_of, py::arg("i"), R"(
Row i, without a copy.

Raises
------
IndexError, InvalidArgument
    There is no such patch; its row was not computed.
)");
    type.def(
        "__matmul__",
        [](const FactorsOfScene& self, const Doubles& x) { return multiply(self.factors.matrix, x); },
        py::arg("x"), py::is_operator());
    // Or numpy would take x @ F for products with single objects.
    type.attr("__array_ufunc__") = py::none();
    type.def("__len__", [](const FactorsOfScene& self) { return self.factors.matrix.size(); });
    type.def("__repr__", [](const FactorsOfScene& self) {
        return fmt::format("<hemi.FormFactors of {} patches, {} entries>", self.factors.matrix.size(),
                           self.factors.matrix.entries());
    });
    type.def(
        "by_patch",
        [](const FactorsOfScene& self) {
            auto result = std::make_shared<FactorsOfScene>(self);
            if (self.factors.parts.any()) {
                result->scene = nullptr;
                result->raw.reset();
                result->csr.reset();
                result->visibility.reset();
                result->factors = run([&] { return merge_parts(self.factors); });
            }
            return result;
        },
        R"(
F of the patches of the scene as it was read, where faces were cut because others touch them.

Returns
-------
FormFactors
    Sums over the parts where light arrives, means by area where it leaves. These, where nothing was cut.
)");
    type.def(
        "by_group", [](const FactorsOfScene& self) { return by_group(self.factors); }, R"(
F summed over groups, weighted by area on the leaving side.

Returns
-------
dict
    groups (names), areas, factors ([g, h]: share of what leaves g that arrives at h), environment, back_faces.

Raises
------
InvalidArgument
    Rows are missing, or the groups are not known.
)");
    type.def(
        "check",
        [](const FactorsOfScene& self, double max_row_error) {
            return check(self.factors, self.scene ? &self.scene->mesh : nullptr, max_row_error);
        },
        py::kw_only(), py::arg("max_row_error") = 1e-4, R"(
Looks for what is wrong with the form factors, or with the geometry that they are of.

Parameters
----------
max_row_error : float
    Tolerance for the environment's share in closed scenes, the back-face share of patches that are not
    buried, and the balance of rows.

Returns
-------
dict
    ok, failures (sentences), enclosure ("closed", "nearly closed", "open"), row_sum, reciprocity,
    largest_factor, above_one, and lists of patches with their share, worst first: leaks, buried, back_faces,
    partly_buried, outside, close, never_visible; reversed: groups whose normals point the wrong way.
)");
    type.def("solve", &solve, py::kw_only(), py::arg("reflectance") = py::none(),
             py::arg("exitance") = py::none(), py::arg("environment") = py::none(),
             py::arg("method") = "auto", py::arg("tolerance") = 1e-6, py::arg("irradiance") = true,
             py::arg("estimate") = true, py::arg("gather") = "off", py::arg("progress") = py::none(), R"(
Radiosity B = E + reflectance·(F B + e B_env) of all patches.

Parameters
----------
reflectance, exitance : array_like, optional
    A number, or of shape [N], [1, channels] or [N, channels]; reflectance in [0, 1), exitance in W/m² or
    lm/m². Without them they are the scene's.
environment : float or array_like, shape [channels], optional
    Exitance of the environment; without it the scene's.
method : {"auto", "gauss-seidel", "jacobi", "cg"}
    Solver.
tolerance : float
    On the relative residual.
irradiance : bool
    Whether the irradiance is found, too.
estimate : bool
    Whether the error that the patches' size makes is estimated, too, where the form factors have an estimate, and
    the values are the scene's. It takes rows of some more patches.
gather : {"off", "on", "auto"}
    Whether the radiosity at the corners of patches is found by rows of their own, for pictures with crisp
    shadows: about as much work as the form factors by "default". "auto": by the presets "default" and "exact",
    where it changes anything.
progress : None, True or callable
    As of form_factors().

Returns
-------
Solution

Raises
------
InputError
    The row of a patch that reflects was not computed.
NotConverged
    The tolerance is not met.
)");
    type.def("save", &save, py::arg("path"), py::kw_only(), py::arg("zone") = "", R"(
Writes a file by its extension: .hff (rows as they were computed, and all that belongs to them), .npz, .npy,
.mtx, .csv, .h5, .txt and .vf (View3D), .dat and .bin (Elmer), .idf (EnergyPlus), .vtp (ParaView).

Parameters
----------
path : path-like
    Of the file.
zone : str
    EnergyPlus' name of what the surfaces close in, of an .idf alone; default: the name of the file.

Raises
------
InvalidArgument
    Another extension, or what the format cannot hold.
IoError
    The file cannot be written.
)");
}

} // namespace

void bind_factors(py::module_& module) {
    bind_row(module);
    bind_estimate(module);
    bind_class(module);
    module.def("form_factors", &form_factors, py::arg("scene").none(false), py::arg("preset") = "default",
               py::kw_only(), py::arg("resolution") = py::none(), py::arg("eye_points") = py::none(),
               py::arg("shadow_rays") = py::none(), py::arg("method") = "hemicube",
               py::arg("rays") = py::none(), py::arg("seed") = py::none(), py::arg("device") = "auto",
               py::arg("jobs") = 0, py::arg("repair") = py::none(), py::arg("estimate") = py::none(),
               py::arg("max_memory") = py::none(), py::arg("patches") = py::none(),
               py::arg("progress") = py::none(), R"(
Computes form factors of a scene.

Parameters
----------
scene : Scene
    Its patches.
preset : {"plain", "fast", "default", "exact"}
    plain: the textbook hemicube; the others: unoccluded factors times visibility, with more and more samples.
resolution : int, optional
    Texels along a hemicube's edge, even, 2 to 4096, instead of the preset's; cells of "hemisphere".
eye_points : int, optional
    Sample points a patch, 1, 4, 9 ... 64, instead of the preset's.
shadow_rays : int, optional
    For every pair that is partly hidden, 0 to 4096, instead of the preset's.
method : {"hemicube", "montecarlo", "contour", "direct", "hemisphere"}
    Hemicubes, or one of the baseline methods, which take no preset and few thousand patches at most.
rays : int, optional
    Of "montecarlo", a patch.
seed : int, optional
    Of the hemicubes' rotations, and of rays.
device : str
    "auto", "cpu", "egl", "egl:N" or "osmesa"; see devices().
jobs : int
    Threads of "cpu", worker processes of OpenGL; 0: one for each core, on a GPU four at most.
repair : {"closure", "reciprocity", "none"}, optional
    What is enforced. Without it: closure where factors have visibility, nothing in plain rows and in single
    rows.
estimate : bool, optional
    Whether the error is estimated, which takes about a tenth of the time. Without it: yes, but for single
    rows.
max_memory : int, optional
    Bytes that rows and pairs may take; without it 80 % of what is free.
patches : sequence of int, optional
    Compute the rows of these alone.
progress : None, True or callable
    Called as progress(phase, done, total), twenty times a second at most; returning False stops the work. True
    shows bars by tqdm.

Returns
-------
FormFactors

Raises
------
InvalidArgument
    A setting out of range, or one that does not apply.
NoDevice, GlError, OutOfMemory
    As their names say.
Cancelled
    `progress` returned False. Ctrl-C raises KeyboardInterrupt.

Notes
-----
The GIL is released. One call at a time works in a process; those of other threads wait. Notes and details go
to the logger "hemi", warnings are HemiWarning.
)");
    module.def("load", &load, py::arg("path"), py::arg("scene") = py::none(), py::kw_only(),
               py::arg("repair") = py::none(), R"(
Reads form factors (.hff, .npz, .mtx, .csv, .txt, .vf, .dat, .bin) or a solution (.hres).

Parameters
----------
path : path-like
    Of the file.
scene : Scene, optional
    What the form factors are of. A .hff must be of the same geometry, of others the size is compared. The
    result then knows what to solve().
repair : {"closure", "reciprocity", "none"}, optional
    What is enforced on the rows of a .hff; as of form_factors().

Returns
-------
FormFactors or Solution

Raises
------
InputError
    The file cannot be read, is damaged, or belongs to another geometry.
)");
}

} // namespace hemi::python
