#pragma once

#include "hemi/core/interrupt.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/engine/clustered_rows.hpp"
#include "hemi/engine/touching_faces.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "pipeline/divided_rows.hpp"
#include "pipeline/observed_rows.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What computing all rows and computing a part of them have in common.
namespace hemi {

// Rows that tell what all of them will need, where there are more than so many.
inline constexpr std::uint32_t sampled_rows = 64;
inline constexpr std::size_t unsampled_rows = 256;

/// Form factors of a scene without any row, nor renderer.
[[nodiscard]] FormFactors describe_form_factors(const Scene& scene, const PatchMesh& mesh,
                                                const FactorSettings& settings);

/// Of N patches those that emit light, 1 each; others 0. Their clusters would be brighter than what stands
/// beside them.
[[nodiscard]] std::vector<std::uint8_t> emitting_patches(const Scene& scene, const PatchMesh& mesh);
/// The same by exitances.
/// @param exitance  N·channels
[[nodiscard]] std::vector<std::uint8_t> emitting_patches(std::uint32_t patches,
                                                         std::span<const double> exitance);

/// What raw rows depend on, besides the renderer.
[[nodiscard]] io::CheckpointKey raw_row_key(const FormFactors& factors, const FactorSettings& settings);

/// The same of rows of clusters.
/// @param factors  whose provenance says what rows of clusters are made of
[[nodiscard]] io::CheckpointKey clustered_row_key(const FormFactors& factors, const FactorSettings& settings,
                                                  const ClusterSettings& clusters);

/// The memory that rows may take, and where that comes from.
[[nodiscard]] std::string memory_limit_text(const FactorSettings& settings);
/// Says what rows will need.
/// @param advice  what would help if they do not fit
/// @throws OutOfMemory if they do not fit
void check_estimate(const MatrixEstimate& estimate, std::size_t rows, const FactorSettings& settings,
                    Observer& observer, std::string_view advice);
/// The same by a sample.
/// @param advice  what would help if they do not fit
/// @throws OutOfMemory if they do not fit
void check_memory(RowProvider& engine, std::span<const std::uint32_t> patches, const FactorSettings& settings,
                  Observer& observer,
                  std::string_view advice = "Larger patches, a lower resolution or a higher limit");

/// What compute_visibility_weighted() needs for some rows of a scene, whose entries are folded over its
/// images.
/// @param samples  rows that are computed, and thrown away
[[nodiscard]] VisibilityWeightedEstimate estimate_pairs(VisibilityProvider& visibility, const PatchMesh& mesh,
                                                        std::span<const std::uint32_t> patches,
                                                        std::uint32_t samples);

/// Says so where a method does not know what is hidden.
void note_unoccluded(Method method, Observer& observer);

/// Better rows by which errors are estimated.
struct ReferencePlan {
    HemicubeSettings hemicube;          ///< that they are made by
    std::vector<std::uint32_t> patches; ///< of which, ascending
};
/// @param known  patches that it may be of, ascending
/// @param size   of the scene, in patches
/// @param most   rows, if their time allows as many
[[nodiscard]] ReferencePlan plan_reference(std::span<const std::uint32_t> known,
                                           const FactorSettings& settings, std::uint32_t size,
                                           std::uint32_t most = usual_reference_rows);

/// The provider's part of computed rows: observed, kept, timed. Ranks observe and keep what they compute.
/// @tparam Row  RowView or VisibilityRow
template <class Row>
class Computation {
public:
    Computation(FormFactors& factors, BasicRowProvider<Row>& provider, Observer& observer,
                RowCheckpoint* checkpoint, io::CheckpointKey key)
        : factors_(factors), observer_(observer), checkpoint_(checkpoint),
          own_(rows_of_rank(provider), observer, checkpoint, std::move(key)), rows_(own_),
          hemicubes_before_(rows_.hemicubes()) {}

    [[nodiscard]] BasicRowProvider<Row>& rows() { return rows_; }
    /// For what shares rows out by itself.
    [[nodiscard]] BasicRowProvider<Row>& rows_of_this_rank() {
        divides_itself_ = true;
        return own_;
    }

    [[nodiscard]] Progress progress(Phase phase) {
        return [this, phase](std::size_t done, std::size_t total) {
            return observer_.progress(phase, done, total);
        };
    }
    /// The same for rows of the engine, whose time counts.
    [[nodiscard]] Progress timed_progress(Phase phase) {
        return [this, phase](std::size_t done, std::size_t total) {
            factors_.work.seconds = watch_.seconds();
            return observer_.progress(phase, done, total);
        };
    }

    /// All rows have come: what made them, and what it took.
    void finish(std::size_t patches) {
        if (divides_itself_) {
            rows_.compare_ranks(hemicubes_before_);
        }
        factors_.work.hemicubes = rows_.hemicubes() - hemicubes_before_;
        factors_.work.rows = patches - (checkpoint_ != nullptr ? checkpoint_->reused() : 0);
        factors_.provenance.renderer = rows_.renderer();
    }
    /// The same, and which patches touch, of rows of F.
    void finish(const PatchMesh& mesh, std::size_t patches) {
        finish(patches);
        factors_.touching = find_touching_faces(factors_.matrix, mesh);
        stop_if_interrupted();
    }

private:
    FormFactors& factors_;
    Observer& observer_;
    RowCheckpoint* checkpoint_;
    ObservedRows<Row> own_; ///< of this rank
    DividedRows<Row> rows_;
    std::uint64_t hemicubes_before_; ///< of samples
    bool divides_itself_ = false;
    Stopwatch watch_;
};

} // namespace hemi
