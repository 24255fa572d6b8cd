#include "engine/hemicube/gl_rows.hpp"

#include "engine/hemicube/item_buffers.hpp"
#include "engine/hemicube/row_accumulator.hpp"
#include "engine/hemicube/view_builder.hpp"
#include "engine/hemicube/visibility_accumulator.hpp"
#include "gl/context.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

namespace hemi {

namespace {

/// Hemicubes a batch. In software, colour and depth of a batch should stay in the second-level cache; a GPU
/// wants much work at once.
std::uint32_t batch_slots(std::uint32_t resolution, bool software) {
    if (!software) {
        return std::clamp(16384u / (3 * resolution), 1u, 64u);
    }
    if (resolution <= 64) {
        return 8;
    }
    if (resolution <= 128) {
        return 4;
    }
    return resolution <= 256 ? 2 : 1;
}

} // namespace

struct GlRows::State {
    /// What a batch in the item buffers is of, slot by slot.
    struct Hemicube {
        std::uint32_t patch;
        std::uint32_t eye;
        FrontViews fronts; ///< visibility only
    };
    using Batch = std::vector<Hemicube>;

    State(const EngineGeometry& the_geometry, const HemicubeSettings& the_settings, RowQuantity quantity,
          std::unique_ptr<gl::Context> own, gl::Context& the_context)
        : geometry(the_geometry), settings(the_settings), weights(the_settings.resolution),
          own_context(std::move(own)), context(&the_context),
          buffers(*context, settings.resolution, batch_slots(settings.resolution, context->software())),
          views(geometry.list, buffers.slots()) {
        if (quantity == RowQuantity::visibility) {
            visibility.emplace(geometry.list, geometry.eyes.patches());
        } else {
            accumulator.emplace(geometry.list.item_of_id, geometry.eyes.patches());
        }
    }

    /// Starts as many hemicubes from `next` on as fit a batch: in slots, and in vertices where the mesh is
    /// large. `next` moves on. A batch ends with a block of the matrix, as the work of a worker does: a
    /// GPU rounds by a hemicube's place in the atlas, which must not depend on the number of workers.
    Batch begin_batch(std::span<const std::uint32_t> patches, std::size_t& next, std::uint32_t& next_eye) {
        constexpr std::size_t enough_vertices = std::size_t{1} << 20;
        Batch batch;
        stream.clear();
        const std::uint32_t block = patches[next] / FormFactorMatrix::block_rows;
        while (batch.size() < buffers.slots() && next < patches.size() &&
               patches[next] / FormFactorMatrix::block_rows == block &&
               (batch.empty() || stream.size() < enough_vertices)) {
            Hemicube& hemicube = batch.emplace_back(Hemicube{patches[next], next_eye, {}});
            const auto eyes = geometry.eyes.of(hemicube.patch);
            const EyePoint& eye = eyes[next_eye];
            views.add(eye, frame(hemicube), static_cast<std::uint32_t>(batch.size()) - 1, stream,
                      visibility ? &hemicube.fronts : nullptr);
            if (++next_eye == eyes.size()) {
                next_eye = 0;
                ++next;
            }
        }
        buffers.begin(stream, static_cast<std::uint32_t>(batch.size()));
        return batch;
    }

    [[nodiscard]] EyeFrame frame(const Hemicube& hemicube) const {
        return {geometry.eyes.of(hemicube.patch)[hemicube.eye].normal, hemicube.patch, hemicube.eye,
                settings.seed};
    }

    /// Weights for an eye point that stands for `share` of its patch; a rule has few different shares.
    const DeltaFormFactors& weights_for(double share) {
        if (share >= 1.0) {
            return weights;
        }
        constexpr std::size_t max_kept = 32;
        const auto found = std::find_if(scaled_weights.begin(), scaled_weights.end(),
                                        [share](const auto& entry) { return entry.first == share; });
        if (found != scaled_weights.end()) {
            return found->second;
        }
        if (scaled_weights.size() == max_kept) {
            scaled_weights.pop_front();
        }
        return scaled_weights.emplace_back(share, weights.scaled(share)).second;
    }

    /// Adds a hemicube to its row; the row itself once it was the last.
    std::optional<RawRow> add(const Hemicube& hemicube, const std::uint32_t* ids) {
        const auto eyes = geometry.eyes.of(hemicube.patch);
        const EyePoint& eye = eyes[hemicube.eye];
        const DeltaFormFactors& eye_weights = weights_for(eye.share);
        const bool last = hemicube.eye + 1 == eyes.size();
        if (visibility) {
            visibility->add(ids, eye_weights, hemicube.fronts, eye, frame(hemicube));
            return last ? std::optional(raw_row(visibility->take())) : std::nullopt;
        }
        accumulator->add(ids, eye_weights);
        return last ? std::optional(accumulator->take()) : std::nullopt;
    }

    /// Forgets hemicubes of a row that was not finished.
    void discard() {
        buffers.discard();
        if (visibility) {
            visibility.emplace(geometry.list, geometry.eyes.patches());
        } else {
            accumulator.emplace(geometry.list.item_of_id, geometry.eyes.patches());
        }
    }

    const EngineGeometry& geometry;
    HemicubeSettings settings;
    DeltaFormFactors weights;
    std::deque<std::pair<double, DeltaFormFactors>> scaled_weights;
    std::unique_ptr<gl::Context> own_context; ///< null where the context is another's
    gl::Context* context;
    ItemBuffers buffers;
    ViewBuilder views;
    std::optional<RowAccumulator> accumulator;       ///< of form factors
    std::optional<VisibilityAccumulator> visibility; ///< or of visibility
    DrawStream stream;
};

GlRows::GlRows(const EngineGeometry& geometry, const HemicubeSettings& settings, RowQuantity quantity,
               const std::string& device) {
    auto context = gl::make_context(device);
    gl::Context& made = *context;
    state_ = std::make_unique<State>(geometry, settings, quantity, std::move(context), made);
}

GlRows::GlRows(const EngineGeometry& geometry, const HemicubeSettings& settings, gl::Context& context)
    : state_(std::make_unique<State>(geometry, settings, RowQuantity::form_factors, nullptr, context)) {}

GlRows::~GlRows() {
    if (state_) {
        try {
            state_->context->make_current(); // the objects go with it
        } catch (...) {                      // nothing left to release into
        }
    }
}

const std::string& GlRows::renderer() const {
    return state_->context->renderer();
}
bool GlRows::software() const {
    return state_->context->software();
}

void GlRows::rows(std::span<const std::uint32_t> patches, const RawRowProvider::Sink& sink) {
    State& state = *state_;
    state.context->make_current();
    const std::size_t texels = std::size_t{3} * state.settings.resolution * state.settings.resolution;
    std::size_t next = 0;
    std::uint32_t next_eye = 0;
    std::deque<State::Batch> under_way;
    try {
        while (next < patches.size() || !under_way.empty()) {
            while (under_way.size() < state.buffers.depth() && next < patches.size()) {
                under_way.push_back(state.begin_batch(patches, next, next_eye));
            }
            const std::uint32_t* ids = state.buffers.finish();
            const State::Batch batch = std::move(under_way.front());
            under_way.pop_front();
            for (std::size_t slot = 0; slot < batch.size(); ++slot) {
                if (const auto row = state.add(batch[slot], ids + slot * texels)) {
                    sink(batch[slot].patch, *row);
                }
            }
        }
    } catch (...) {
        state.discard(); // a sink that stops must not leave batches behind
        throw;
    }
}

std::vector<std::uint32_t> GlRows::items(std::uint32_t patch, std::uint32_t eye) {
    state_->context->make_current();
    std::size_t next = 0;
    static_cast<void>(state_->begin_batch(std::span(&patch, 1), next, eye));
    const std::uint32_t* ids = state_->buffers.finish();
    std::vector<std::uint32_t> items(std::size_t{3} * state_->settings.resolution *
                                     state_->settings.resolution);
    for (std::size_t texel = 0; texel < items.size(); ++texel) {
        items[texel] = state_->geometry.list.item_of_id[ids[texel]];
    }
    state_->buffers.restore_defaults();
    return items;
}

} // namespace hemi
