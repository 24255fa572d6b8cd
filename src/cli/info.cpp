#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/text.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/cost.hpp"

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

std::string cost_text(const FactorCost& cost, const PatchMesh& mesh) {
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
    text += summary_line("enclosure", to_word(scene.enclosure));
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
            {"enclosure", to_word(scene.enclosure)},
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
    const FactorCost cost = arguments.measure ? measure_cost(loaded.mesh, arguments.rows.factors)
                                              : estimate_cost(loaded.mesh, arguments.rows.factors);
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
        object["renderer"] = result.solution.renderer;
        object["solver"] = {{"name", to_word(result.solution.method)},
                            {"sweeps", result.solution.sweeps},
                            {"residual", result.solution.residual}};
        object["chosen_for"] = result.solution.chosen_for;
        object["error_estimate"] = error_json(result.solution.factor_error, result.solution.error);
        print_json(object);
    } else {
        print(contents_text(contents) + summary_line("renderer", result.solution.renderer) +
              summary_line("solver", fmt::format("{}, {}, residual {:.3g}", to_word(result.solution.method),
                                                 plural(result.solution.sweeps, "sweep", "sweeps"),
                                                 result.solution.residual)) +
              chosen_summary(result.solution.chosen_for) +
              error_summary(result.solution.factor_error, result.solution.error) + tables_text(contents));
    }
}

std::string_view preset_word(const Provenance& provenance) {
    return provenance.preset ? to_word(*provenance.preset) : "none";
}

void show_factors(const InfoArguments& arguments) {
    const FormFactors file = io::read_hff(arguments.scene.path);
    const RowSums sums = row_sums(file.matrix);
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
        print_json(with_head("factors", {{"patches", file.matrix.size()},
                                         {"rows", sums.known},
                                         {"entries", file.matrix.entries()},
                                         {"memory", file.matrix.memory_bytes()},
                                         {"preset", preset_word(file.provenance)},
                                         {"method", to_word(file.provenance.method)},
                                         {"resolution", file.provenance.resolution},
                                         {"eye_points", file.provenance.eye_points},
                                         {"shadow_rays", file.provenance.shadow_rays},
                                         {"seed", file.provenance.seed},
                                         {"renderer", file.provenance.renderer},
                                         {"enclosure", to_word(file.enclosure)},
                                         {"geometry_hash", fmt::format("{:016x}", file.geometry_hash)},
                                         {"row_sum", row_sum_json(sums)},
                                         {"chosen_for", file.provenance.chosen_for},
                                         {"error_estimate", error_json(file.error)},
                                         {"groups", groups}}));
        return;
    }
    std::string text = summary_line("patches", count_text(file.matrix.size()));
    text += summary_line("rows", fmt::format("{} computed", count_text(sums.known)));
    text += summary_line("entries", fmt::format("{}, {}", count_text(file.matrix.entries()),
                                                memory_text(file.matrix.memory_bytes())));
    text += summary_line(
        "made by",
        fmt::format("{}, preset {}, resolution {}, {}, {}, seed {}", to_word(file.provenance.method),
                    preset_word(file.provenance), file.provenance.resolution,
                    plural(file.provenance.eye_points, "sample point", "sample points"),
                    plural(file.provenance.shadow_rays, "shadow ray", "shadow rays"), file.provenance.seed));
    text += summary_line("renderer", file.provenance.renderer);
    text += summary_line("enclosure", to_word(file.enclosure));
    text += summary_line("geometry", fmt::format("{:016x}", file.geometry_hash));
    text += summary_line("row sums", row_sum_text(sums));
    text += chosen_summary(file.provenance.chosen_for) + error_summary(file.error);
    Table groups({"group", "patches", "area"});
    for (std::size_t g = 0; g < areas.size(); ++g) {
        groups.add({file.groups[g], count_text(patches[g]), number_text(areas[g])});
    }
    print(text + "\n" + groups.text());
}

void show_foreign_factors(const InfoArguments& arguments) {
    const FormFactorMatrix factors = io::read_factors(arguments.scene.path).matrix;
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
    } else if (io::factor_content(path)) {
        show_foreign_factors(arguments);
    } else {
        throw InvalidArgument(
            fmt::format("{}: info reads {}, .hres, .hff, .mtx, .csv, .npz, .txt, .vf, .dat and .bin",
                        path.string(), io::scene_extensions()));
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
