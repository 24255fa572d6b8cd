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

/// What is in the file.
Report info_report(const char* kind, const Report& contents) {
    Report report{"", {{"schema", "hemi/info/1"}, {"kind", kind}}};
    report.add(contents);
    return report;
}

Report scene_info(const InfoArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    const FactorCost cost = arguments.measure ? measure_cost(loaded.mesh, arguments.rows.factors)
                                              : estimate_cost(loaded.mesh, arguments.rows.factors);
    return info_report("scene", contents_report(loaded.scene, loaded.mesh,
                                                cost_report(cost, loaded.mesh, arguments.measure)));
}

Report file_info(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".hres") {
        const io::ResultFile result = io::read_hres(path);
        const PatchMesh mesh(result.scene, result.subdivision);
        return info_report("result",
                           contents_report(result.scene, mesh, stored_solution_report(result.solution)));
    }
    if (extension == ".hff") {
        return info_report("factors", stored_factors_report(io::read_hff(path)));
    }
    if (io::factor_content(path)) {
        return info_report("factors", matrix_report(io::read_factors(path).matrix));
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
