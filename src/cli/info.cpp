#include "cli/commands.hpp"
#include "cli/error_report.hpp"
#include "cli/outputs.hpp"
#include "cli/pipeline.hpp"
#include "cli/report.hpp"
#include "cli/stored_factors.hpp"
#include "engine/hemicube/draw_list.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <thread>

namespace hemi::cli {

namespace {

/// What a scene or a stored solution consists of.
struct Contents {
    const Scene& scene;
    const PatchMesh& mesh;

    [[nodiscard]] std::size_t triangles() const {
        return static_cast<std::size_t>(
            std::count_if(mesh.surfaces().begin(), mesh.surfaces().end(),
                          [](const Surface& surface) { return surface.vertex_count == 3; }));
    }
};

struct GroupCounts {
    std::uint32_t surfaces = 0;
    std::uint32_t patches = 0;
    double area = 0.0;
};

std::vector<GroupCounts> count_groups(const PatchMesh& mesh) {
    std::vector<GroupCounts> groups(mesh.groups().size());
    for (const Surface& surface : mesh.surfaces()) {
        ++groups[surface.group].surfaces;
    }
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        GroupCounts& group = groups[mesh.group(i)];
        ++group.patches;
        group.area += mesh.areas()[i];
    }
    return groups;
}

struct Cost {
    double entries_per_row = 0.0;
    std::uint64_t memory = 0;
    double seconds = 0.0;
    std::string renderer; ///< empty: a rule of thumb, nothing was measured
    unsigned cores = 1;
};

/// A rule of thumb, from scenes of 2,000 to 20,000 patches. A patch sees about half of the others; texels
/// show only one of those that share one. On the software rasteriser a hemicube of resolution 128 takes a
/// core 0.5 ms and 1 µs more for every polygon drawn, a third more where what is hidden is counted too; then
/// a pair takes 0.1 µs.
Cost rule_of_thumb(const PatchMesh& mesh, const RowOptions& options) {
    const double patches = mesh.size();
    const RowPlan plan = plan_rows(options, mesh.size());
    const double resolution = plan.hemicube.resolution;
    const double texels = 3.0 * resolution * resolution;
    const double in_view = 0.5 * patches;
    Cost cost;
    cost.cores = options.jobs > 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency());
    const auto polygons = static_cast<double>(count_draw_polygons(mesh, options.merge));
    const double hemicube = 0.1e-3 + 0.4e-3 * resolution * resolution / (128.0 * 128.0) + 1e-6 * polygons;
    const double hemicubes = patches * plan.hemicube.eye_points;
    if (plan.hybrid) {
        const double pairs = 0.5 * patches * patches;
        cost.entries_per_row = in_view;
        cost.memory = static_cast<std::uint64_t>(patches * (1.2 * (9.0 * in_view + 25.0) + 4.0 * patches));
        cost.seconds = (1.33 * hemicube * hemicubes + 0.1e-6 * pairs) / cost.cores;
    } else {
        cost.entries_per_row = texels * -std::expm1(-in_view / texels);
        cost.memory = static_cast<std::uint64_t>(1.2 * patches * (8.0 * cost.entries_per_row + 25.0));
        cost.seconds = hemicube * hemicubes / cost.cores;
    }
    return cost;
}

Cost measure(const PatchMesh& mesh, const RowOptions& options) {
    const RowPlan plan = plan_rows(options, mesh.size());
    const auto take = [](const auto& estimate, const std::string& renderer) {
        Cost cost;
        cost.entries_per_row = estimate.entries_per_row;
        cost.memory = estimate.memory_bytes;
        cost.seconds = estimate.seconds;
        cost.renderer = renderer;
        return cost;
    };
    const auto patches = all_patches(mesh.size());
    if (plan.hybrid) {
        const auto engine = make_visibility(mesh, plan.hemicube, options);
        return take(estimate_visibility_weighted(*engine, patches), engine->renderer());
    }
    const auto engine = make_engine(mesh, plan.hemicube, options);
    return take(estimate_matrix(*engine, patches), engine->renderer());
}

std::string cost_text(const Cost& cost, const PatchMesh& mesh) {
    std::string text =
        summary_line("memory", fmt::format("about {} for {} rows of {:.0f} entries", memory_text(cost.memory),
                                           count_text(mesh.size()), cost.entries_per_row));
    const std::string basis =
        cost.renderer.empty()
            ? fmt::format("rule of thumb for software OpenGL on {}; --measure times 64 rows",
                          cost.cores == 1 ? "1 core" : fmt::format("{} cores", cost.cores))
            : fmt::format("measured on {}", cost.renderer);
    return text + summary_line("time", fmt::format("about {} ({})", seconds_text(cost.seconds), basis));
}

std::string values_text(const std::vector<double>& values) {
    std::vector<std::string> words;
    for (const double value : values) {
        words.push_back(number_text(value));
    }
    return fmt::format("{}", fmt::join(words, " "));
}

std::string contents_text(const Contents& contents) {
    const auto& [scene, mesh] = contents;
    const std::size_t triangles = contents.triangles();
    const std::size_t quads = mesh.surfaces().size() - triangles;
    std::string text = summary_line("name", scene.name.empty() ? "-" : scene.name);
    text += summary_line("surfaces", fmt::format("{} ({}, {})", count_text(mesh.surfaces().size()),
                                                 plural(triangles, "triangle", "triangles"),
                                                 plural(quads, "quadrilateral", "quadrilaterals")));
    text += summary_line("patches", count_text(mesh.size()));
    text += summary_line("channels", fmt::format("{}", fmt::join(scene.channels, ", ")));
    const Bounds& bounds = mesh.bounds();
    text += summary_line("bounds", fmt::format("{} {} {} to {} {} {}", number_text(bounds.lower.x),
                                               number_text(bounds.lower.y), number_text(bounds.lower.z),
                                               number_text(bounds.upper.x), number_text(bounds.upper.y),
                                               number_text(bounds.upper.z)));
    text += summary_line("enclosure", enclosure_name(scene.enclosure));
    text += summary_line("environment", values_text(scene.environment));
    text += summary_line("camera", scene.camera ? "yes" : "no");
    return text;
}

std::string tables_text(const Contents& contents) {
    const auto& [scene, mesh] = contents;
    Table groups({"group", "surfaces", "patches", "area"});
    const std::vector<GroupCounts> counts = count_groups(mesh);
    double area = 0.0;
    for (std::size_t g = 0; g < counts.size(); ++g) {
        groups.add({mesh.groups()[g], count_text(counts[g].surfaces), count_text(counts[g].patches),
                    number_text(counts[g].area)});
        area += counts[g].area;
    }
    groups.add({"(all)", count_text(mesh.surfaces().size()), count_text(mesh.size()), number_text(area)});
    Table materials({"material", "reflectance", "exitance"}, 3);
    for (const Material& material : scene.materials) {
        materials.add({material.name, values_text(material.reflectance), values_text(material.exitance)});
    }
    return fmt::format("\n{}\n{}", groups.text(), materials.text());
}

Json contents_json(const Contents& contents) {
    const auto& [scene, mesh] = contents;
    const Bounds& bounds = mesh.bounds();
    const std::size_t triangles = contents.triangles();
    Json groups = Json::array();
    const std::vector<GroupCounts> counts = count_groups(mesh);
    for (std::size_t g = 0; g < counts.size(); ++g) {
        groups.push_back({{"name", mesh.groups()[g]},
                          {"surfaces", counts[g].surfaces},
                          {"patches", counts[g].patches},
                          {"area", counts[g].area}});
    }
    Json materials = Json::array();
    for (const Material& material : scene.materials) {
        materials.push_back({{"name", material.name},
                             {"reflectance", material.reflectance},
                             {"exitance", material.exitance}});
    }
    return {{"name", scene.name},
            {"surfaces", mesh.surfaces().size()},
            {"triangles", triangles},
            {"quadrilaterals", mesh.surfaces().size() - triangles},
            {"patches", mesh.size()},
            {"channels", scene.channels},
            {"bounds",
             {{"lower", {bounds.lower.x, bounds.lower.y, bounds.lower.z}},
              {"upper", {bounds.upper.x, bounds.upper.y, bounds.upper.z}}}},
            {"enclosure", enclosure_name(scene.enclosure)},
            {"environment", scene.environment},
            {"camera", scene.camera.has_value()},
            {"groups", groups},
            {"materials", materials}};
}

Json with_head(const char* kind, const Json& body) {
    Json object{{"schema", "hemi/info/1"}, {"kind", kind}};
    object.update(body);
    return object;
}

void show_scene(const InfoArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    const Contents contents{loaded.scene, loaded.mesh};
    const Cost cost =
        arguments.measure ? measure(loaded.mesh, arguments.rows) : rule_of_thumb(loaded.mesh, arguments.rows);
    if (arguments.common.json) {
        Json object = with_head("scene", contents_json(contents));
        object["estimate"] = {{"measured", arguments.measure},
                              {"renderer", arguments.measure ? Json(cost.renderer) : Json(nullptr)},
                              {"entries_per_row", cost.entries_per_row},
                              {"memory", cost.memory},
                              {"seconds", cost.seconds}};
        print_json(object);
    } else {
        print(contents_text(contents) + cost_text(cost, loaded.mesh) + tables_text(contents));
    }
}

void show_result(const InfoArguments& arguments) {
    const io::ResultFile result = io::read_hres(arguments.scene.path);
    const PatchMesh mesh(result.scene, result.subdivision);
    const Contents contents{result.scene, mesh};
    if (arguments.common.json) {
        Json object = with_head("result", contents_json(contents));
        object["renderer"] = result.renderer;
        object["solver"] = {
            {"name", result.solver}, {"sweeps", result.sweeps}, {"residual", result.residual}};
        object["chosen_for"] = result.chosen_for;
        object["error_estimate"] = error_json(result.factor_error, result.radiosity_error);
        print_json(object);
    } else {
        print(contents_text(contents) + summary_line("renderer", result.renderer) +
              summary_line("solver", fmt::format("{}, {}, residual {:.3g}", result.solver,
                                                 plural(result.sweeps, "sweep", "sweeps"), result.residual)) +
              chosen_summary(result.chosen_for) + error_summary(result.factor_error, result.radiosity_error) +
              tables_text(contents));
    }
}

void show_factors(const InfoArguments& arguments) {
    const io::FactorFile file = io::read_hff(arguments.scene.path);
    const RowSums sums = row_sums(file.factors);
    std::vector<double> areas(file.groups.size(), 0.0);
    std::vector<std::uint64_t> patches(file.groups.size(), 0);
    for (std::size_t i = 0; i < file.group_of.size(); ++i) {
        areas[file.group_of[i]] += file.areas[i];
        ++patches[file.group_of[i]];
    }
    if (arguments.common.json) {
        Json groups = Json::array();
        for (std::size_t g = 0; g < areas.size(); ++g) {
            groups.push_back({{"name", file.groups[g]}, {"patches", patches[g]}, {"area", areas[g]}});
        }
        print_json(with_head("factors", {{"patches", file.factors.size()},
                                         {"rows", sums.known},
                                         {"entries", file.factors.entries()},
                                         {"memory", file.factors.memory_bytes()},
                                         {"preset", file.preset},
                                         {"method", file.method},
                                         {"resolution", file.resolution},
                                         {"eye_points", file.eye_points},
                                         {"shadow_rays", file.shadow_rays},
                                         {"seed", file.seed},
                                         {"renderer", file.renderer},
                                         {"enclosure", file.enclosure},
                                         {"geometry_hash", fmt::format("{:016x}", file.geometry_hash)},
                                         {"row_sum", row_sum_json(sums)},
                                         {"chosen_for", file.chosen_for},
                                         {"error_estimate", error_json(file.error)},
                                         {"groups", groups}}));
        return;
    }
    std::string text = summary_line("patches", count_text(file.factors.size()));
    text += summary_line("rows", fmt::format("{} computed", count_text(sums.known)));
    text += summary_line("entries", fmt::format("{}, {}", count_text(file.factors.entries()),
                                                memory_text(file.factors.memory_bytes())));
    text += summary_line(
        "made by", fmt::format("{}, preset {}, resolution {}, {}, {}, seed {}", file.method, file.preset,
                               file.resolution, plural(file.eye_points, "eye point", "eye points"),
                               plural(file.shadow_rays, "shadow ray", "shadow rays"), file.seed));
    text += summary_line("renderer", file.renderer);
    text += summary_line("enclosure", file.enclosure);
    text += summary_line("geometry", fmt::format("{:016x}", file.geometry_hash));
    text += summary_line("row sums", row_sum_text(sums));
    text += chosen_summary(file.chosen_for) + error_summary(file.error);
    Table groups({"group", "patches", "area"});
    for (std::size_t g = 0; g < areas.size(); ++g) {
        groups.add({file.groups[g], count_text(patches[g]), number_text(areas[g])});
    }
    print(text + "\n" + groups.text());
}

void show_foreign_factors(const InfoArguments& arguments) {
    const FormFactorMatrix factors = read_factors(arguments.scene.path).factors;
    const RowSums sums = row_sums(factors);
    if (arguments.common.json) {
        print_json(with_head("factors", {{"patches", factors.size()},
                                         {"entries", factors.entries()},
                                         {"memory", factors.memory_bytes()},
                                         {"row_sum", row_sum_json(sums)}}));
        return;
    }
    print(summary_line("patches", count_text(factors.size())) +
          summary_line("entries", fmt::format("{}, {}", count_text(factors.entries()),
                                              memory_text(factors.memory_bytes()))) +
          summary_line("row sums", row_sum_text(sums)));
}

} // namespace

ExitStatus run(const InfoArguments& arguments, const Terminal& terminal) {
    const std::filesystem::path& path = arguments.scene.path;
    const std::string extension = extension_of(path);
    const bool is_scene = io::is_scene_file(path);
    if (!is_scene) {
        refuse_all_but(arguments.common, {}, path);
    }
    if (is_scene) {
        show_scene(arguments, terminal);
    } else if (extension == ".hres") {
        show_result(arguments);
    } else if (extension == ".hff") {
        show_factors(arguments);
    } else if (is_foreign_factor_file(path)) {
        show_foreign_factors(arguments);
    } else {
        throw InvalidArgument(
            fmt::format("{}: info reads {}, .hres, .hff, .mtx, .csv, .npz, .txt, .vf, .dat and .bin",
                        path.string(), io::scene_extensions()));
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
