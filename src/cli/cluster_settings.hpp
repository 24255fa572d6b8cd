#pragma once

#include "cli/arguments/arguments.hpp"
#include "hemi/core/diagnostics.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/solver/solver.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

/// What commands make of `--clusters`, and of rows that a file holds with clusters.
namespace hemi::cli {

/// What keeps rows from being those of clusters.
struct ClusterObstacle {
    std::string_view option;
    std::string_view why;
};

/// What of a solver keeps rows from being those of clusters.
[[nodiscard]] std::optional<ClusterObstacle> obstacle_of_solver(const SolverSettings& solver);

/// Turns clusters off where something keeps rows from being those of clusters.
/// @param more  of the command, beside what the options of rows say
/// @throws InvalidArgument where they are asked for all the same, or `--cluster-error` has no effect
void settle_clusters(const CommonOptions& common, RowOptions& rows,
                     std::optional<ClusterObstacle> more = std::nullopt);

/// Form factors of single patches from ones with clusters, with a note; others stay as they are.
/// @param target      what needs them, for messages: a file
/// @param max_memory  bytes that they may take
/// @throws OutOfMemory
void expand_clusters(FormFactors& factors, const std::filesystem::path& target, std::uint64_t max_memory,
                     Diagnostics& diagnostics);

/// @param path  that rows were read from
/// @param need  what needs factors of single patches, for the message
/// @throws InputError for rows with clusters
void refuse_clusters(const FormFactors& factors, const std::filesystem::path& path, std::string_view need);

} // namespace hemi::cli
