#include "cli/commands.hpp"
#include "cli/picture_output.hpp"
#include "cli/pipeline.hpp"
#include "cli/report.hpp"
#include "cli/solution.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>

namespace hemi::cli {

ExitStatus run(const RenderArguments& arguments, const Terminal& terminal) {
    const Stopwatch total;
    PictureOptions options = arguments.picture;
    if (!options.output) {
        options.output = arguments.input.filename().replace_extension(".png");
    }
    Outputs outputs;
    add_picture_output(outputs, options);
    if (outputs.uses_standard_output() && arguments.common.json) {
        throw InvalidArgument("--json and an output to - cannot both go to standard output");
    }
    if (extension_of(arguments.input) != ".hres") {
        throw InvalidArgument(
            fmt::format("{}: render draws a stored solution, .hres; `hemi solve SCENE --result "
                        "FILE.hres` makes one, `hemi solve SCENE -o PICTURE` draws at once",
                        arguments.input.string()));
    }
    const io::ResultFile result = io::read_hres(arguments.input);
    const PatchMesh mesh(result.scene, result.subdivision);
    const double load = total.seconds();
    const WrittenPicture picture = write_picture(
        {result.scene, mesh, result.radiosity, patch_exitance(result.scene, mesh), result.blocked}, options,
        arguments.device);
    const double seconds = total.seconds();
    if (arguments.common.json) {
        print_json({{"schema", "hemi/render/1"},
                    {"picture", options.output->string()},
                    {"width", options.size[0]},
                    {"height", options.size[1]},
                    {"exposure", picture.exposure},
                    {"seconds", {{"load", load}, {"render", seconds - load}, {"total", seconds}}}});
    } else if (!terminal.quiet()) {
        const std::string text = summary_line("picture", picture.text);
        if (outputs.uses_standard_output()) {
            std::fputs(text.c_str(), stderr);
        } else {
            print(text);
        }
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
