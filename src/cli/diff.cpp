#include "cli/commands.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/report/diff_report.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/difference.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

/// A solution from a file, with what compare_solutions() needs.
struct Stored {
    io::ResultFile result;
    PatchMesh mesh;

    explicit Stored(const std::filesystem::path& path)
        : result(io::read_hres(path)), mesh(result.scene, result.subdivision) {
        io::complete_solution(result, mesh);
    }
    [[nodiscard]] SolutionOf solution() const { return {result.scene, mesh, result.solution}; }
};

void check_input(const std::filesystem::path& path) {
    if (extension_of(path) != ".hres") {
        throw InvalidArgument(fmt::format("{}: diff compares stored solutions, .hres; `hemi solve SCENE "
                                          "--result FILE.hres` makes one",
                                          path.string()));
    }
}

void write_csv(const std::filesystem::path& path, const PatchMesh& mesh, const SolutionDifference& found) {
    const std::vector<io::CellArray> arrays{{"first", found.first.values, {}},
                                            {"second", found.second, {}},
                                            {"difference", found.difference, {}}};
    io::write_patch_table(path, mesh, arrays);
}

} // namespace

ExitStatus run(const DiffArguments& arguments, const Terminal& terminal) {
    check_input(arguments.first);
    check_input(arguments.second);
    Outputs outputs;
    outputs.keep(arguments.first);
    outputs.keep(arguments.second);
    if (arguments.picture.output) {
        outputs.add("-o", *arguments.picture.output, {".png"}, true);
    }
    if (arguments.csv) {
        outputs.add("--csv", *arguments.csv, {".csv"}, true);
    }
    outputs.refuse_with_json(arguments.common.json);
    const Stored first(arguments.first);
    const Stored second(arguments.second);
    const SolutionDifference found = compare_solutions(
        first.solution(), second.solution(), *arguments.picture.quantity, arguments.picture.channel);
    if (arguments.csv) {
        write_csv(*arguments.csv, first.mesh, found);
    }
    Report picture;
    if (arguments.picture.output) {
        picture = write_false_colours(first.result.scene, first.mesh, difference_colours(found),
                                      arguments.picture, arguments.device,
                                      fmt::format("difference of {}", to_word(*arguments.picture.quantity)));
    }
    Report report = diff_report(found, first.mesh.groups(), to_word(*arguments.picture.quantity),
                                arguments.picture.channel, first.result.scene.unit.value_or(1.0));
    report.json["first"] = arguments.first.string();
    report.json["second"] = arguments.second.string();
    report.text = picture.text + report.text;
    report.select("hemi/diff/1",
                  {"first", "second", "quantity", "channel", "unit", "patches", "pairing", "off", "farthest",
                   "groups", "areas", "means", "difference", "rms", "largest", "all"});
    outputs.show(report, arguments.common.json, terminal);
    return ExitStatus::ok;
}

} // namespace hemi::cli
