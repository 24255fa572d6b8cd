#include "cli/loaded_scene.hpp"

#include "cli/face_exitances.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/paths.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/scene/contact.hpp"
#include "hemi/scene/orientation.hpp"
#include "hemi/scene/thermal_exitance.hpp"
#include "hemi/scene/triangle_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <system_error>
#include <utility>

namespace hemi::cli {

namespace {

void replace_environment(Scene& scene, const std::vector<double>& environment) {
    const std::size_t channels = scene.channels.size();
    if (environment.size() != 1 && environment.size() != channels) {
        throw InvalidArgument(fmt::format("--environment: {} values; the scene has {}, so give 1 or {}",
                                          environment.size(), plural(channels, "channel", "channels"),
                                          channels));
    }
    for (const double value : environment) {
        if (!(value >= 0.0)) {
            throw InvalidArgument(fmt::format("--environment {}; must not be negative", value));
        }
    }
    scene.environment = environment;
    scene.environment.resize(channels, environment[0]);
}

PatchMesh make_mesh(const Scene& scene, const SceneOptions& options) {
    try {
        return PatchMesh(scene, options.subdivision);
    } catch (const InvalidArgument& error) {
        if (options.subdivision == Subdivision{}) { // the scene's own wish
            throw InputError(fmt::format("{}: {}", options.path.string(), error.what()));
        }
        throw;
    }
}

std::vector<Surface> surfaces_with_grids(const PatchMesh& mesh) {
    std::vector<Surface> surfaces(mesh.surfaces().begin(), mesh.surfaces().end());
    for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
        surfaces[s].patches = mesh.grid(s);
    }
    return surfaces;
}

/// Faces that stand on others are as people build them; faces in the place of others are a mistake, mostly.
void warn_of_overlaps(const Imprint& cut, const Scene& as_read, const Terminal& terminal) {
    const std::vector<std::uint32_t> numbers = face_numbers(as_read.surfaces);
    const auto warn = [&](Imprint::What what, const char* one, const char* many) {
        std::size_t count = 0;
        const Imprint::Finding* first = nullptr;
        for (const Imprint::Finding& finding : cut.findings) {
            if (finding.what == what && finding.other < as_read.surfaces.size()) {
                first = count++ == 0 ? &finding : first;
            }
        }
        if (first != nullptr) {
            const auto name = [&](std::uint32_t face) {
                return fmt::format("face {} of {}", numbers[face],
                                   as_read.groups[as_read.surfaces[face].group]);
            };
            terminal.warn(fmt::format("{}: {} by {}{}", plural(count, one, many), name(first->face),
                                      name(first->other), count > 1 ? ", ..." : ""));
        }
    };
    warn(Imprint::What::duplicate, "face is left out, covered by another one in its plane",
         "faces are left out, covered by others in their planes");
    warn(Imprint::What::overlapped, "face is cut, where another one lies on it in its plane",
         "faces are cut, where others lie on them in their planes");
}

/// Where patches are those of the user, who is told one value of each. Patches of a size can be made smaller.
void warn_of_divided_patches(const Imprint& cut, const Scene& as_read, const Subdivision& subdivision,
                             const Terminal& terminal) {
    std::size_t count = 0;
    const Imprint::Divided* first = nullptr;
    for (const Imprint::Divided& divided : cut.divided) {
        const bool by_size = subdivision.patch_size || (as_read.patch_size && !subdivision.patches_per_face &&
                                                        !as_read.surfaces[divided.face].patches);
        if (!by_size) {
            first = count++ == 0 ? &divided : first;
        }
    }
    if (first == nullptr) {
        return;
    }
    const std::vector<std::uint32_t> numbers = face_numbers(as_read.surfaces);
    const auto group = [&](std::uint32_t face) { return as_read.groups[as_read.surfaces[face].group]; };
    terminal.warn(fmt::format("{} on both sides of a sheet, and what is told of each is a mean over both: "
                              "patch {} of {} by face {} of {}{}; "
                              "patches that end at the sheet tell the sides apart",
                              plural(count, "patch lies", "patches lie"), first->patch, group(first->face),
                              numbers[first->sheet], group(first->sheet), count > 1 ? ", ..." : ""));
}

void warn_of_near_contacts(const Scene& scene, const Terminal& terminal) {
    const std::vector<NearContact> contacts = near_contacts(scene);
    if (!contacts.empty()) {
        const std::vector<std::uint32_t> numbers = face_numbers(scene.surfaces);
        const auto name = [&](std::uint32_t face) {
            return fmt::format("face {} of {}", numbers[face], scene.groups[scene.surfaces[face].group]);
        };
        terminal.warn(fmt::format(
            "{} just short of other faces, and light passes between them: {} by {:.3g} of {}{}; where they "
            "should touch, join them",
            plural(contacts.size(), "edge of a sheet ends", "edges of sheets end"), name(contacts[0].sheet),
            contacts[0].gap, name(contacts[0].face), contacts.size() > 1 ? ", ..." : ""));
    }
}

void warn_of_turned_faces(const Scene& scene, const Terminal& terminal) {
    const std::vector<std::uint32_t> turned = turned_against_others(scene);
    if (!turned.empty()) {
        terminal.warn(fmt::format(
            "{} turned against the others: face {} of {}{}; --orient in or out turns them",
            plural(turned.size(), "face of a watertight body is", "faces of watertight bodies are"),
            face_numbers(scene.surfaces)[turned[0]], scene.groups[scene.surfaces[turned[0]].group],
            turned.size() > 1 ? ", ..." : ""));
    }
}

/// Of what the command line or the file says and nothing comes of.
void warn_of_no_effect(const Scene& scene, const SceneOptions& options, const Terminal& terminal) {
    if (!options.environment.empty() && scene.enclosure == Enclosure::closed) {
        terminal.warn("--environment has no effect: the scene is closed, and nothing comes in");
    }
    const bool all_have_patches =
        !scene.surfaces.empty() &&
        std::all_of(scene.surfaces.begin(), scene.surfaces.end(),
                    [](const Surface& surface) { return surface.patches.has_value(); });
    if (scene.patch_size && all_have_patches) {
        terminal.warn(fmt::format("{}: \"patch_size\" has no effect: every surface has \"patches\"",
                                  options.path.string()));
    }
}

} // namespace

void advise_patch_size(const LoadedScene& loaded, const Terminal& terminal) {
    constexpr std::size_t enough = 1000; // patches, to see how light changes
    const Scene& scene = loaded.scene;
    const auto shines = [](double value) { return value > 0.0; };
    const bool lit = scene.sun || scene.sky ||
                     std::any_of(scene.environment.begin(), scene.environment.end(), shines) ||
                     std::any_of(scene.surfaces.begin(), scene.surfaces.end(), [&](const Surface& surface) {
                         const std::vector<double>& exitance = scene.materials[surface.material].exitance;
                         return std::any_of(exitance.begin(), exitance.end(), shines);
                     });
    if (!lit || loaded.patches().size() >= enough || !loaded.has_whole_faces()) {
        return;
    }
    const double area = std::accumulate(loaded.mesh.areas().begin(), loaded.mesh.areas().end(), 0.0);
    terminal.warn(fmt::format("every face is one patch, on which the light is one value: --patch-size {:.1g} "
                              "makes about {} of them",
                              std::sqrt(area / enough), count_text(enough)));
}

LoadedScene load_scene(const SceneOptions& options, const Terminal& terminal) {
    const Stopwatch watch;
    if (!options.reader.two_sided_groups.empty() && io::extension_of(options.path) == ".json") {
        throw InvalidArgument("--two-sided is not for JSON scenes, which say \"two_sided\": true");
    }
    Diagnostics diagnostics;
    std::vector<std::filesystem::path> paths{options.path};
    paths.insert(paths.end(), options.also.begin(), options.also.end());
    Scene scene = io::read_scenes(paths, options.reader, diagnostics);
    const bool thermal = scene.thermal && (!scene.thermal->conditions.empty() ||
                                           scene.thermal->environment_temperature.has_value());
    if (!options.reader.adiabatic) {
        radiate_by_temperature(scene, diagnostics);
    }
    terminal.warn(diagnostics);
    if (options.exitance_from) {
        set_exitances(scene, *options.exitance_from);
    }
    warn_of_turned_faces(scene, terminal);
    if (options.reader.up && !options.up_is_visible && !scene.sky && !scene.sun) {
        throw InvalidArgument(
            fmt::format("--up: {} has neither sun nor sky, and no picture is drawn", options.path.string()));
    }
    scene.enclosure = options.enclosure.value_or(scene.enclosure);
    if (!options.environment.empty()) {
        replace_environment(scene, options.environment);
    }
    warn_of_no_effect(scene, options, terminal);
    PatchMesh mesh = make_mesh(scene, options);
    join_triangle_pairs(scene, options.subdivision);
    if (scene.surfaces.size() != mesh.surfaces().size()) {
        mesh = make_mesh(scene, options);
    }
    Subdivision subdivision = options.subdivision;
    warn_of_near_contacts(scene, terminal);
    std::optional<SceneAsRead> as_read;
    if (auto cut = imprint(scene, subdivision, options.imprint)) {
        warn_of_overlaps(*cut, scene, terminal);
        warn_of_divided_patches(*cut, scene, subdivision, terminal);
        std::vector<Surface> surfaces = surfaces_with_grids(mesh);
        PatchMesh whole = mesh.whole_faces().mesh;
        mesh = PatchMesh(cut->scene);
        io::PatchPlaces left = io::places_left(whole, mesh, cut->parts);
        as_read = {std::exchange(scene, std::move(cut->scene)),
                   std::move(surfaces),
                   std::move(whole),
                   std::move(cut->parts),
                   std::move(left),
                   std::move(cut->findings),
                   cut->covered};
        subdivision = {};
    }
    std::vector<std::uint32_t> group_of(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        group_of[i] = mesh.group(i);
    }
    stop_if_interrupted();
    return {
        std::move(scene), std::move(mesh), std::move(subdivision), std::move(as_read), std::move(group_of),
        watch.seconds(),  thermal};
}

void LoadedScene::adopt(PatchMesh other, const CoarseMesh& begin, bool parts) {
    if (has_whole_faces() && !parts) {
        SceneAsRead before = as_read ? std::move(*as_read)
                                     : SceneAsRead{scene, surfaces_with_grids(mesh), mesh, {}, {}, {}, 0.0};
        before.parts = parts_of_faces(other, begin, before.mesh);
        before.left = io::places_left(before.mesh, other, before.parts);
        as_read = std::move(before);
    } else {
        as_read.reset();
    }
    mesh = std::move(other);
    adopt_mesh(scene, subdivision, mesh);
    group_of.clear();
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        group_of.push_back(mesh.group(i));
    }
}

bool LoadedScene::has_whole_faces() const {
    const PatchMesh& own = patches();
    for (std::uint32_t face = 0; face < own.surfaces().size(); ++face) {
        if (own.patches_per_side(face) != 1 || own.surfaces()[face].joins) {
            return false;
        }
    }
    return true;
}

std::vector<double> LoadedScene::means(std::span<const double> values, std::size_t channels) const {
    return as_read ? means_of_patches(as_read->parts, mesh.areas(), values, channels)
                   : std::vector<double>(values.begin(), values.end());
}

io::ResultFile LoadedScene::result(Solution solution) const {
    io::ResultFile file{scene, subdivision, std::move(solution)};
    if (as_read) {
        file.surfaces_as_read = as_read->surfaces;
        file.parts = as_read->parts;
    }
    return file;
}

void LoadedScene::write_patches(const std::filesystem::path& path) const {
    io::write_patches_csv(path, patches(), as_read ? as_read->left : io::PatchPlaces());
}

void LoadedScene::write_patches(const std::filesystem::path& path, const FormFactorMatrix& factors) const {
    std::vector<double> environment;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        environment.push_back(factors.known(i) ? factors.environment(i)
                                               : std::numeric_limits<double>::quiet_NaN());
    }
    const std::vector<io::CellArray> arrays{{"environment", means(environment, 1), {}}};
    io::write_patch_table(path, patches(), arrays, as_read ? as_read->left : io::PatchPlaces());
}

CoarseMesh coarse_begin(const LoadedScene& loaded, const SceneOptions& options) {
    return options.subdivision != Subdivision{} ? loaded.as_begin()
                                                : coarse_mesh(loaded.uncut(), options.imprint);
}

void check_budget(const RefinementOptions& refinement, const RowOptions& rows) {
    if (refinement.budget > 0.0 && !refinement.asked(rows)) {
        throw InvalidArgument("--budget needs --error-target or --refine, by which patches are cut");
    }
}

CutMesh mesh_of_rows(const LoadedScene& loaded, const SceneOptions& options,
                     const std::filesystem::path& path) {
    const io::RowsGeometry rows = io::read_hff_geometry(path);
    if (rows.geometry_hash == loaded.mesh.geometry_hash()) {
        return {loaded.as_begin(), loaded.mesh};
    }
    for (const bool own : {false, true}) {
        CoarseMesh begin = own ? loaded.as_begin() : coarse_begin(loaded, options);
        try {
            PatchMesh mesh = rows.cuts.any() ? begin.mesh.cut(rows.cuts) : begin.mesh;
            if (mesh.size() == rows.patches && mesh.geometry_hash() == rows.geometry_hash) {
                return {std::move(begin), std::move(mesh)};
            }
        } catch (const InvalidArgument&) { // they are no cuts of this
        }
    }
    return {loaded.as_begin(), loaded.mesh}; // by which read_form_factors() refuses them
}

void adopt_mesh_of_rows(LoadedScene& loaded, const SceneOptions& options, const std::filesystem::path& path,
                        bool parts) {
    std::error_code ignored; // a name that no file can have
    if (!std::filesystem::is_regular_file(path, ignored)) {
        return;
    }
    CutMesh cut = mesh_of_rows(loaded, options, path);
    if (cut.mesh.geometry_hash() != loaded.mesh.geometry_hash()) {
        loaded.adopt(std::move(cut.mesh), cut.begin, parts);
    }
}

void refuse_chosen_settings(const CommonOptions& common, const RowOptions& rows) {
    if (!rows.error_target || rows.error_of != ErrorOf::factors) {
        return;
    }
    for (const std::string& option : common.given) {
        if (option == "--preset" || option == "--eye-points" || option == "--resolution" ||
            option == "--shadow-rays") {
            throw InvalidArgument(fmt::format("{} is what --error-target chooses; leave one out", option));
        }
    }
}

void refuse_all_but(const CommonOptions& common, std::span<const std::string> allowed,
                    const std::filesystem::path& file) {
    static const std::vector<std::string> always{"--json", "--quiet", "--verbose", "--color"};
    for (const std::string& option : common.given) {
        if (std::find(allowed.begin(), allowed.end(), option) == allowed.end() &&
            std::find(always.begin(), always.end(), option) == always.end()) {
            throw InvalidArgument(
                fmt::format("{} does not apply to {}, which is not a scene", option, file.string()));
        }
    }
}

} // namespace hemi::cli
