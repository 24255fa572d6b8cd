#pragma once

#include "hemi/pipeline/accuracy.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/radiosity_reference.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hemi {

/// What something costs, and what one gets.
struct Offer {
    double seconds = 0.0; ///< that it takes
    double error = 0.0;   ///< above 0
};

/// Offers that nothing beats: no other is as fast and as good, and faster or better.
/// @param offers  in any order
/// @return for every offer whether it is one of them
[[nodiscard]] std::vector<bool> pareto_front(std::span<const Offer> offers);

/// Which offers suit whom: indices, where there are such offers.
struct Recommendation {
    std::optional<std::size_t> best;          ///< least product of time and error on the front
    std::optional<std::size_t> faster;        ///< the slowest of the front that is much faster than the best
    std::optional<std::size_t> more_accurate; ///< the quickest of the front that is much better
};
/// Recommends three of the offers on the front.
/// @param offers  in any order
/// @param useful  what is below its time or its error counts as these: nobody gains by less
[[nodiscard]] Recommendation recommend(std::span<const Offer> offers, const Offer& useful);

/// Speed against accuracy, measured on one scene: of form factors on the scene's own patches, and of whole
/// solutions on patches of several sizes.
struct Trade {
    /// Form factors by one candidate.
    struct Entry {
        Candidate candidate;                    ///< what was tried
        std::optional<Measurement> measurement; ///< how it did
        std::string omitted;                    ///< why there is no measurement
        bool front = false;                     ///< nothing is both faster and better

        /// Seconds for all rows.
        [[nodiscard]] double seconds() const { return measurement->seconds; }
        /// Error of a row (2-norm, rms over rows), at least what float factors can show.
        [[nodiscard]] double error() const;
    };

    /// What a whole solution takes, and how far its light is from the exact one.
    struct Answer {
        Candidate candidate;                ///< of the form factors
        std::optional<double> patch_size;   ///< longest patch edge; empty: the scene's own, or refined
        std::optional<double> error_target; ///< of `vertices`, that patches were refined to; empty: uniform
        std::uint32_t patches = 0;          ///< of its mesh
        double seconds = 0.0;     ///< rows, closure, solver, gather; of refined patches also estimates
        std::uint64_t memory = 0; ///< bytes that form factors took at most, about
        bool gathered = false;    ///< whether vertices were gathered
        RadiosityError error;     ///< against the reference
        double row_error = 0.0;   ///< of form factors: 2-norm of a row, rms over rows
        bool front = false;       ///< nothing is both faster and better

        /// Error of the picture, at least what can be told apart.
        [[nodiscard]] double vertices() const;
    };

    std::vector<Entry> entries;  ///< in the order in which they were tried: cheap ones first
    Reference reference;         ///< what they were judged by
    std::vector<Answer> answers; ///< coarse patches first
    std::optional<RadiosityReference> answer_reference; ///< what these were judged by
    std::string unanswered; ///< why there are no answers, a sentence; empty: there are
    /// Answers that there was no time or memory for, that failed, or that do not apply: what, and why.
    std::vector<std::pair<std::string, std::string>> omitted;

    /// Measured entries, quickest first.
    [[nodiscard]] std::vector<const Entry*> by_time() const;
    /// Answers, quickest first.
    [[nodiscard]] std::vector<const Answer*> answers_by_time() const;
    /// Of answers() the best, by the error of the picture.
    [[nodiscard]] Recommendation recommended_answers() const;
    /// Of the measured entries in by_time(), by the error of a row.
    [[nodiscard]] Recommendation recommended_entries() const;
};

/// Measures the trade of speed against accuracy within about `budget` seconds.
///
/// Whole solutions come first: by the presets on uniform patches, from coarse ones down to the scene's own
/// size and below, halving sizes as long as the budget allows; and on patches that are refined to several
/// error targets. All are compared with light gathered from a mesh that is finer than each of them and
/// nowhere coarser, see find_radiosity_reference(). Scenes without light or reflection have no such answers,
/// and what fails is left out. Form factors are compared on the scene's own patches with rows of many sample
/// points: each candidate on a sample first, then on all rows if half of what time is left will do.
/// @param scene         as read
/// @param mesh          its patches
/// @param subdivision   by which the mesh was made
/// @param with_imprint  whether faces were cut where they touch
/// @param base          device, workers, seed, memory
/// @param budget        seconds
/// @param observer      gets progress and may cancel
/// @throws as find_reference()
[[nodiscard]] Trade measure_trade(const Scene& scene, const PatchMesh& mesh, const Subdivision& subdivision,
                                  bool with_imprint, const FactorSettings& base, double budget,
                                  Observer& observer = no_observer());

} // namespace hemi
