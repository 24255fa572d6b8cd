#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/loaded_scene.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <filesystem>
#include <memory>
#include <optional>

/// Form factors from a file or from the engine, kept while they are computed.
namespace hemi::cli {

/// Raw form factors from a `.hff` that belongs to the scene.
/// @throws InputError if it belongs to another geometry; InvalidArgument if a setting that was given on the
///   command line is not the file's.
[[nodiscard]] FormFactors reuse_rows(const std::filesystem::path& path, const LoadedScene& loaded,
                                     const FactorSettings& settings, const CommonOptions& common);

/// Says what rows a failed run kept, if any, and how to resume from them.
void report_checkpoint(const RowCheckpoint* checkpoint, const Terminal& terminal);

/// Calls work(checkpoint), which computes rows for `output` and writes it, and returns what it does. Where it
/// fails, says what rows were kept and how to resume. The checkpoint is null where there is no output.
template <class Work>
auto with_checkpoint(const std::optional<std::filesystem::path>& output, bool resume,
                     const Terminal& terminal, Work&& work) {
    std::unique_ptr<RowCheckpoint> checkpoint;
    if (output) {
        checkpoint = std::make_unique<RowCheckpoint>(*output, resume);
    }
    try {
        return work(checkpoint.get());
    } catch (...) {
        report_checkpoint(checkpoint.get(), terminal);
        throw;
    }
}

} // namespace hemi::cli
