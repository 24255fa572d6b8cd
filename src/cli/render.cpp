#include "cli/commands.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/point_source.hpp"
#include "cli/report/seconds.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/result_file.hpp"

#include <fmt/format.h>

namespace hemi::cli {

ExitStatus run(const RenderArguments& arguments, const Terminal& terminal) {
    Seconds seconds({"load", "render"});
    PictureOptions options = arguments.picture;
    if (!options.output) {
        options.output = arguments.input.filename().replace_extension(".png");
    }
    Outputs outputs;
    add_picture_output(outputs, options, true);
    outputs.refuse_with_json(arguments.common.json);
    if (arguments.dots.points) {
        outputs.keep(*arguments.dots.points);
        if (extension_of(*options.output) == ".hdr") {
            throw InvalidArgument("--points: dots are drawn into a .png; .hdr holds light");
        }
    }
    if (extension_of(arguments.input) != ".hres") {
        throw InvalidArgument(
            fmt::format("{}: render draws a stored solution, .hres; `hemi solve SCENE --result "
                        "FILE.hres` makes one, `hemi solve SCENE -o PICTURE` draws at once",
                        arguments.input.string()));
    }
    const Stopwatch load_watch;
    io::ResultFile result = io::read_hres(arguments.input);
    const PatchMesh mesh(result.scene, result.subdivision);
    io::complete_solution(result, mesh);
    std::optional<Dots> dots;
    if (arguments.dots.points) {
        dots = read_dots(arguments.dots, mesh.bounds());
        dots->shown.legend = options.legend;
    }
    seconds["load"] = load_watch.seconds();
    const Stopwatch render_watch;
    Report report = write_picture(result.scene, mesh, result.solution, options, arguments.device,
                                  dots ? &*dots : nullptr);
    seconds["render"] = render_watch.seconds();
    report.json.update(seconds.report().json);
    report.select("hemi/render/1", {"picture", "width", "height", "exposure", "quantity", "seconds"});
    outputs.show(report, arguments.common.json, terminal);
    return ExitStatus::ok;
}

} // namespace hemi::cli
