#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/scene_report.hpp"
#include "cli/report/solution_report.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/cost.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

Report scene_info(const InfoArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    const FactorCost cost = measure_cost(loaded.mesh, arguments.rows.factors, true);
    Report more = imprint_report(loaded, terminal.verbose());
    more.add(cost_report(cost, loaded.mesh));
    Report report = contents_report(
        loaded.uncut(), loaded.patches(),
        loaded.as_read ? std::span<const double>(loaded.as_read->left.areas) : loaded.mesh.areas(), more);
    report.json["kind"] = "scene";
    report.select("hemi/info/1", {"kind", "name", "surfaces", "triangles", "quadrilaterals", "polygons",
                                  "patches", "channels", "bounds", "enclosure", "environment", "symmetry",
                                  "camera", "imprint", "groups", "materials", "estimate"});
    return report;
}

Report file_info(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".hres") {
        io::ResultFile result = io::read_hres(path);
        const PatchMesh mesh(result.scene, result.subdivision);
        io::complete_solution(result, mesh);
        Report more;
        const bool has_parts = result.parts.any();
        const Scene scene = result.scene_as_read();
        const PatchMesh patches = result.patches_as_read();
        if (has_parts) {
            more.add("parts", count_text(mesh.size()));
        }
        more.add(stored_solution_report(result.solution, mesh));
        const io::PatchPlaces left = io::places_left(patches, mesh, result.parts);
        Report report = contents_report(scene, patches,
                                        has_parts ? std::span<const double>(left.areas) : mesh.areas(), more);
        report.json["kind"] = "result";
        report.json["parts"] = mesh.size();
        report.select("hemi/info/1",
                      {"kind",           "name",        "surfaces", "triangles",  "quadrilaterals",
                       "polygons",       "patches",     "parts",    "channels",   "bounds",
                       "enclosure",      "environment", "symmetry", "camera",     "groups",
                       "materials",      "renderer",    "solver",   "chosen_for", "error",
                       "error_estimate", "temperature", "net_flux"});
        return report;
    }
    if (extension == ".hff") {
        Report report = stored_factors_report(io::read_hff(path));
        report.json["kind"] = "factors";
        report.select("hemi/info/1",
                      {"kind",          "patches",     "parts",      "rows",           "entries",
                       "memory",        "clusters",    "preset",     "method",         "resolution",
                       "eye_points",    "shadow_rays", "seed",       "renderer",       "enclosure",
                       "geometry_hash", "row_sum",     "chosen_for", "error_estimate", "groups"});
        return report;
    }
    if (io::factor_content(path)) {
        Report report = matrix_report(io::read_factors(path).matrix);
        report.json["kind"] = "factors";
        report.select("hemi/info/1", {"kind", "patches", "entries", "memory", "row_sum"});
        return report;
    }
    throw InvalidArgument(
        fmt::format("{}: info reads {}, .hres, .hff, .mtx, .csv, .npz, .txt, .vf, .dat and .bin",
                    path.string(), io::scene_extensions()));
}

} // namespace

ExitStatus run(const InfoArguments& arguments, const Terminal& terminal) {
    const std::filesystem::path& path = arguments.scene.path;
    const bool is_scene = io::is_scene_file(path);
    if (!is_scene) {
        refuse_all_but(arguments.common, {}, path);
    }
    show(is_scene ? scene_info(arguments, terminal) : file_info(path), arguments.common.json);
    return ExitStatus::ok;
}

} // namespace hemi::cli
