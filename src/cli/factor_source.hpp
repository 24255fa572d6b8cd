#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/loaded_scene.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

/// Form factors from a file or from the engine, kept while they are computed.
namespace hemi::cli {

/// Whether `--factors` names rows that are there.
[[nodiscard]] bool has_rows(const SolveArguments& arguments);
/// Raw form factors of a file.
/// @throws InputError if it belongs to another geometry; InvalidArgument if a setting that was given on the
///   command line is not the file's.
[[nodiscard]] FormFactors read_rows(const std::filesystem::path& path, const LoadedScene& loaded,
                                    const FactorSettings& settings, const CommonOptions& common);
/// Raw form factors: those of the `--factors` file if it is there, else computed and stored in it.
/// @param patches     whose rows are computed
/// @param checkpoint  discarded when the rows are complete; may be null
/// @throws InputError if the file belongs to another geometry or rows are missing; InvalidArgument if a
///   setting that was given on the command line is not the file's.
[[nodiscard]] FormFactors find_rows(const SolveArguments& arguments, const LoadedScene& loaded,
                                    std::span<const std::uint32_t> patches, Observer& observer,
                                    const Terminal& terminal, RowCheckpoint* checkpoint);
/// Raw form factors of the `--factors` file, from which patches are to be cut further.
/// @param mesh      that they are of, see mesh_of_rows()
/// @param settings  become those of the rows where the command line does not say them
/// @throws InputError if rows are missing; InvalidArgument as find_rows(), or if they are of no hemicubes
[[nodiscard]] FormFactors rows_to_refine(const SolveArguments& arguments, const Scene& scene,
                                         const PatchMesh& mesh, FactorSettings& settings);
/// Adds better rows, by which errors are estimated, where those of a file have none: of a refinement that was
/// interrupted, or made without an estimate. Warns where there can be none.
/// @param factors   raw
/// @param settings  that the rows were not made by: device, workers, memory
void add_missing_reference(FormFactors& factors, const PatchMesh& mesh, FactorSettings settings,
                           Observer& observer);
/// Writes raw form factors to the `--factors` file, if there is to be one.
void store_rows(const SolveArguments& arguments, FormFactors& raw, const Terminal& terminal);

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
