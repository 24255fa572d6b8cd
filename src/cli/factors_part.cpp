#include "cli/factor_source.hpp"
#include "cli/factors.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/report/scene_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/pipeline/factor_parts.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

/// The rows that are meant, of all.
RowRange range_of(const RowSelection& selection, std::uint32_t size) {
    if (!selection.shares) {
        if (selection.second > size) {
            throw InvalidArgument(fmt::format("--rows {}:{}: the scene has {}, counted from 0",
                                              selection.first, selection.second,
                                              plural(size, "row", "rows")));
        }
        return {selection.first, selection.second};
    }
    if (selection.second > size) {
        throw InvalidArgument(fmt::format("--rows {}/{}: the scene has only {}", selection.first,
                                          selection.second, plural(size, "row", "rows")));
    }
    const auto begin = [&](std::uint32_t share) {
        return static_cast<std::uint32_t>(std::uint64_t{size} * share / selection.second);
    };
    return {begin(selection.first - 1), begin(selection.first)};
}

ExitStatus write_part(const FactorsArguments& arguments, const Outputs& outputs, const Terminal& terminal,
                      RowCheckpoint* checkpoint) {
    Seconds seconds({"load", "factors"});
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    seconds["load"] = loaded.seconds;
    const RowRange range = range_of(*arguments.selection, loaded.mesh.size());
    TerminalObserver observer(terminal);
    const Stopwatch watch;
    io::FactorPart part =
        compute_factor_part(loaded.scene, loaded.mesh, range, arguments.rows.factors, observer, checkpoint);
    part.parts = loaded.parts();
    seconds["factors"] = watch.seconds();
    io::write_factor_part(*arguments.output, loaded.mesh, part);
    checkpoint->discard();
    if (arguments.patches) {
        loaded.write_patches(*arguments.patches);
    }
    Report report = scene_size_report(loaded);
    report.add("renderer", part.provenance.renderer, {{"renderer", part.provenance.renderer}});
    report.add("rows", fmt::format("{} to {} of {}", range.first, range.end - 1, count_text(part.size)),
               {{"rows", {range.first, range.end}}, {"size", part.size}});
    report.add(seconds.report());
    report.add("written", arguments.output->string() + " (a part, for `hemi merge`)");
    report.select("hemi/factors-part/1",
                  {"renderer", "patches", "parts", "groups", "rows", "size", "seconds"});
    outputs.show(report, arguments.common.json, terminal);
    return ExitStatus::ok;
}

} // namespace

ExitStatus factors_part(const FactorsArguments& arguments, const Outputs& outputs, const Terminal& terminal) {
    return with_checkpoint(arguments.output, arguments.rows.resume, terminal, [&](RowCheckpoint* checkpoint) {
        return write_part(arguments, outputs, terminal, checkpoint);
    });
}

} // namespace hemi::cli
