#pragma once

#include "cli/pipeline.hpp"
#include "hemi/engine/baselines.hpp"
#include "hemi/matrix/error_estimate.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Ways to find the rows of a scene, each tried on a few rows: for `hemi trade` and `--error-target`.
namespace hemi::cli {

/// A method with its settings.
struct Candidate {
    std::string family;   ///< "plain", "hybrid", "Monte Carlo" …: those that differ in settings only
    std::string settings; ///< "4 x 64": eye points and resolution; "4096 rays"
    std::string command;  ///< options by which `solve` and `factors` do the same; empty: they cannot
    RowOptions options;   ///< of a hemicube
    std::optional<BaselineSettings> yardstick;

    [[nodiscard]] std::string label() const { return family + (settings.empty() ? "" : " " + settings); }
};

/// Hemicubes of a preset, with the preset's eye points and resolution where these are 0, and its shadow rays
/// where there are none.
/// @param base  device, jobs, seed and the like
[[nodiscard]] Candidate hemicube_candidate(const RowOptions& base, const std::string& preset,
                                           std::uint32_t patches, std::uint32_t eye_points = 0,
                                           std::uint32_t resolution = 0,
                                           std::optional<std::uint32_t> shadow_rays = {});
[[nodiscard]] Candidate baseline_candidate(const RowOptions& base, BaselineMethod method,
                                           std::uint32_t rays = 0);

/// Rows by which contenders are judged.
struct Reference {
    std::vector<std::uint32_t> patches;
    FormFactorMatrix rows{0};
    HemicubeSettings settings;
    std::string renderer;
    double seconds = 0.0;
};
/// Of as many of `patches`, spread over all, as fit into about `seconds`: 8 to 32; by more eye points than
/// any preset has.
[[nodiscard]] Reference find_reference(const LoadedScene& loaded, std::span<const std::uint32_t> patches,
                                       const RowOptions& base, double seconds);

/// How a candidate did.
struct Measurement {
    double seconds = 0.0;  ///< for all rows: taken, or what those of the reference took times what is missing
    bool all_rows = false; ///< else those of the reference alone
    FactorErrorEstimate error;
    std::optional<double> radiosity; ///< relative rms error, where there is a radiosity to judge by
};
/// Tries a candidate on the reference's rows. What comes out is on the safe side for a hybrid, whose pairs
/// are seen from one end only, and whose rows are not closed.
/// @param count      of rows that `seconds` are to be for
/// @param radiosity  N·channels of about what it is; may be empty
[[nodiscard]] Measurement try_on_sample(const LoadedScene& loaded, const Candidate& candidate,
                                        const Reference& reference, std::size_t count,
                                        std::span<const double> radiosity);
/// Computes all rows of a candidate, repairs them as `solve` does, and judges them.
/// @param rows  gets the rows; may be null
[[nodiscard]] Measurement try_on_all(const LoadedScene& loaded, const Candidate& candidate,
                                     const Reference& reference, std::span<const double> radiosity,
                                     io::FactorFile* rows = nullptr);

/// Bytes that all rows of a hybrid need at least: its table of pairs. 0 for others.
[[nodiscard]] std::uint64_t table_of_pairs(const Candidate& candidate, std::uint32_t patches,
                                           std::size_t rows);

} // namespace hemi::cli
