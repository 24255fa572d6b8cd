#pragma once

#include "hemi/core/error.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// A way to find the rows of a scene, to be tried against others.
struct Candidate {
    FactorSettings settings; ///< how
    std::string
        family; ///< "plain", "visibility-weighted", "Monte Carlo" …: those that differ in settings only
    std::string variant; ///< "4x64": sample points and resolution; "4096 rays"

    /// Family and variant.
    [[nodiscard]] std::string label() const { return family + (variant.empty() ? "" : " " + variant); }
    /// The preset, or the method, and what was set over it, for a sentence.
    [[nodiscard]] std::string description() const;
    /// Whether it is hemicubes by a preset with nothing set over it.
    [[nodiscard]] bool is_preset() const;
};
/// Hemicubes by a preset, with what is set over it.
/// @param base         device, jobs, seed, memory and repair
/// @param preset       what the settings begin with
/// @param patches      size of the scene
/// @param eye_points   sample points a patch; empty: the preset's
/// @param resolution   texels along a hemicube edge; empty: the preset's
/// @param shadow_rays  for a partly hidden pair; empty: the preset's
[[nodiscard]] Candidate hemicube_candidate(const FactorSettings& base, Preset preset, std::uint32_t patches,
                                           std::optional<std::uint32_t> eye_points = {},
                                           std::optional<std::uint32_t> resolution = {},
                                           std::optional<std::uint32_t> shadow_rays = {});
/// A baseline method.
/// @param base    seed and memory
/// @param method  which one
/// @param rays    of montecarlo, a patch
[[nodiscard]] Candidate baseline_candidate(const FactorSettings& base, Method method, std::uint32_t rays = 0);

/// Rows by which candidates are judged.
struct Reference {
    std::vector<std::uint32_t> patches; ///< whose rows they are, ascending
    FormFactorMatrix rows{0};           ///< N rows, these known
    HemicubeSettings settings;          ///< of their visibility
    std::string renderer;               ///< what computed them
    double seconds = 0.0;               ///< that took
};
/// Reference rows of as many of `patches`, spread over all, as fit into about `seconds`: 8 to 32; with more
/// sample points than any preset has.
/// @throws Cancelled if the observer stops it; as make_visibility_provider()
[[nodiscard]] Reference find_reference(const PatchMesh& mesh, std::span<const std::uint32_t> patches,
                                       const FactorSettings& base, double seconds,
                                       Observer& observer = no_observer());

/// How a candidate did.
struct Measurement {
    double seconds = 0.0;  ///< for all rows: taken, or those of the reference's rows times what is missing
    bool all_rows = false; ///< else those of the reference alone
    FactorErrorEstimate error;       ///< of the rows
    std::optional<double> radiosity; ///< relative rms error, where there is a radiosity to judge by
};
/// Tries a candidate on the reference's rows. Errors are upper ones where factors are visibility-weighted:
/// pairs are seen from one end only, and rows are not closed.
/// @param scene      materials and enclosure
/// @param mesh       its patches
/// @param candidate  what is tried
/// @param reference  what it is judged by
/// @param count      number of rows that `seconds` are to be for
/// @param radiosity  N·channels of about what it is; may be empty
/// @param observer   gets progress and may cancel
[[nodiscard]] Measurement try_on_sample(const Scene& scene, const PatchMesh& mesh, const Candidate& candidate,
                                        const Reference& reference, std::size_t count,
                                        std::span<const double> radiosity,
                                        Observer& observer = no_observer());
/// Computes all rows of a candidate, prepares them, and judges them.
/// @param scene      materials and enclosure
/// @param mesh       its patches
/// @param candidate  what is tried
/// @param reference  what it is judged by
/// @param radiosity  N·channels of about what it is; may be empty
/// @param rows       gets the form factors; may be null
/// @param observer   gets progress and may cancel
[[nodiscard]] Measurement try_on_all(const Scene& scene, const PatchMesh& mesh, const Candidate& candidate,
                                     const Reference& reference, std::span<const double> radiosity,
                                     FormFactors* rows = nullptr, Observer& observer = no_observer());
/// Bytes that all rows of a candidate need at least: its table of pairs. 0 where there is none.
[[nodiscard]] std::uint64_t pair_table_bytes(const Candidate& candidate, std::uint32_t patches,
                                             std::size_t rows);

/// No settings within the limits reach an error target. what() says how far the best ones come.
class TargetMissed : public Error {
public:
    using Error::Error;
};

/// What a search for settings found.
struct TargetResult {
    FormFactors raw;             ///< as they are stored
    FormFactors factors;         ///< prepared
    Solution solution;           ///< of solve_to_target()
    double search_seconds = 0.0; ///< spent on choosing settings
    double factor_seconds = 0.0; ///< spent on form factors
};
/// The cheapest settings whose rows err by no more than `target` (2-norm of a row, rms over rows), by the
/// estimate: each is judged by a few rows before all are computed.
/// @param scene     gives the enclosure
/// @param mesh      its patches
/// @param base      device, jobs, seed, memory and repair
/// @param target    largest error that will do
/// @param observer  gets progress and may cancel
/// @throws TargetMissed; as compute_form_factors
[[nodiscard]] TargetResult factors_to_target(const Scene& scene, const PatchMesh& mesh,
                                             const FactorSettings& base, double target,
                                             Observer& observer = no_observer());
/// The cheapest settings by which the reflected radiosity errs by no more than `target`, relative and rms, by
/// the estimate. The patches' size is not part of it.
/// @param scene            materials, environment, enclosure
/// @param mesh             its patches
/// @param patches          whose rows are needed
/// @param base             device, jobs, seed, memory and repair
/// @param solver           solver, tolerance
/// @param target           largest error that will do
/// @param observer         gets progress and may cancel
/// @param with_irradiance  see solve_radiosity()
/// @throws TargetMissed; InvalidArgument if nothing reflects; as compute_form_factors and solve_radiosity
[[nodiscard]] TargetResult solve_to_target(const Scene& scene, const PatchMesh& mesh,
                                           std::span<const std::uint32_t> patches, const FactorSettings& base,
                                           const SolverSettings& solver, double target,
                                           Observer& observer = no_observer(), bool with_irradiance = true);

} // namespace hemi
