#include "hemi/pipeline/trade.hpp"
#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/trade_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace hemi::cli {

ExitStatus run(const TradeArguments& arguments, const Terminal& terminal) {
    const Stopwatch total;
    Outputs outputs;
    if (arguments.output) {
        outputs.add("-o", *arguments.output, {".svg"}, true);
        outputs.refuse_with_json(arguments.common.json);
    }
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(fmt::format("{}: trade needs a scene ({})", arguments.scene.path.string(),
                                          io::scene_extensions()));
    }
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    if (loaded.mesh.size() < 2) {
        throw InvalidArgument(fmt::format("{}: a scene of {} has no factors to compare",
                                          arguments.scene.path.string(),
                                          plural(loaded.mesh.size(), "patch", "patches")));
    }
    TerminalObserver observer(terminal);
    const Trade trade =
        measure_trade(loaded.uncut(), loaded.mesh, arguments.scene.subdivision, arguments.scene.imprint,
                      arguments.rows.factors, arguments.budget, observer);
    if (arguments.output && !(trade.by_time().empty() && trade.answers.empty())) {
        io::OutputFile file(*arguments.output);
        file.write(trade_drawing(trade, loaded));
        file.commit();
    }
    const Report report = trade_report(trade, loaded, arguments.scene, arguments.budget, total.seconds());
    if (outputs.uses_standard_output()) { // never with --json
        std::fputs(report.text.c_str(), stderr);
    } else {
        show(report, arguments.common.json);
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
