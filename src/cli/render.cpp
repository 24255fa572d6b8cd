#include "cli/commands.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/report/seconds.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/result_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hemi::cli {

ExitStatus run(const RenderArguments& arguments, const Terminal& terminal) {
    Seconds seconds({"load", "render"});
    PictureOptions options = arguments.picture;
    if (!options.output) {
        options.output = arguments.input.filename().replace_extension(".png");
    }
    Outputs outputs;
    add_picture_output(outputs, options);
    outputs.refuse_with_json(arguments.common.json);
    if (extension_of(arguments.input) != ".hres") {
        throw InvalidArgument(
            fmt::format("{}: render draws a stored solution, .hres; `hemi solve SCENE --result "
                        "FILE.hres` makes one, `hemi solve SCENE -o PICTURE` draws at once",
                        arguments.input.string()));
    }
    const Stopwatch load_watch;
    io::ResultFile result = io::read_hres(arguments.input);
    const PatchMesh mesh(result.scene, result.subdivision);
    result.solution.exitance = patch_values(mesh, result.scene.materials, &Material::exitance);
    seconds["load"] = load_watch.seconds();
    const Stopwatch render_watch;
    const WrittenPicture picture =
        write_picture(result.scene, mesh, result.solution, options, arguments.device);
    seconds["render"] = render_watch.seconds();
    if (arguments.common.json) {
        Json object{{"schema", "hemi/render/1"},
                    {"picture", options.output->string()},
                    {"width", options.size[0]},
                    {"height", options.size[1]},
                    {"exposure", picture.exposure}};
        object.update(seconds.report().json);
        print_json(object);
    } else {
        outputs.print_summary(summary_line("picture", picture.text), terminal);
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
