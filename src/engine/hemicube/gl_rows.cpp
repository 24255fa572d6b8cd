#include "engine/hemicube/gl_rows.hpp"

#include "engine/hemicube/clipped_polygons.hpp"
#include "engine/hemicube/gpu_polygons.hpp"
#include "engine/hemicube/item_buffers.hpp"
#include "engine/hemicube/row_accumulator.hpp"
#include "engine/hemicube/visibility_accumulator.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <functional>
#include <optional>
#include <string_view>
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

/// Whether the GPU transforms and clips the polygons: hardware that can does, unless the environment variable
/// HEMI_TRANSFORM says otherwise, which tests do.
bool transforms_on_gpu(bool software) {
    const char* const wanted = std::getenv("HEMI_TRANSFORM");
    const std::string_view where = wanted != nullptr ? wanted : "";
    if (where != "" && where != "cpu" && where != "gpu") {
        throw InvalidArgument(fmt::format("HEMI_TRANSFORM={}; must be cpu or gpu", where));
    }
    if (!where.empty()) {
        return where == "gpu";
    }
    constexpr GLint needed_blocks = 2; // of vertex shaders; OpenGL grants none
    GLint blocks = 0;
    glGetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &blocks);
    return !software && blocks >= needed_blocks;
}

} // namespace

struct GlRows::State {
    /// A hemicube of a batch, slot by slot.
    struct Hemicube {
        std::uint32_t patch;
        std::uint32_t eye;
        std::uint32_t row = 0; ///< of the batch's tallies, if it has any
        FrontViews fronts{};   ///< visibility of clipped polygons only
    };
    using Batch = std::vector<Hemicube>;

    State(const EngineGeometry& the_geometry, const HemicubeSettings& the_settings, RowQuantity quantity,
          std::unique_ptr<gl::Context> own, gl::Context& the_context)
        : geometry(the_geometry), settings(the_settings),
          weights(the_settings.resolution, the_geometry.measure), own_context(std::move(own)),
          context(&the_context), on_gpu(transforms_on_gpu(context->software())),
          counts(on_gpu && quantity == RowQuantity::visibility),
          buffers(*context, settings.resolution, batch_slots(settings.resolution, context->software()),
                  counts ? geometry.list.item_of_id.size() : 0) {
        if (on_gpu) {
            drawer = std::make_unique<GpuPolygons>(geometry.list, buffers.atlas(), counts);
        } else {
            drawer = std::make_unique<ClippedPolygons>(geometry.list, buffers.atlas());
        }
        reset(quantity == RowQuantity::visibility);
    }

    /// Starts as many hemicubes from `next` on as fit a batch. `next` moves on. A batch ends with a block of
    /// the matrix, as the work of a worker does: a GPU rounds by a hemicube's place in the atlas, which must
    /// not depend on the number of workers.
    Batch begin_batch(std::span<const std::uint32_t> patches, std::size_t& next, std::uint32_t& next_eye) {
        Batch batch;
        counting.clear();
        const std::uint32_t block = patches[next] / FormFactorMatrix::block_rows;
        while (batch.size() < buffers.atlas().slots && !drawer->full() && next < patches.size() &&
               patches[next] / FormFactorMatrix::block_rows == block) {
            Hemicube hemicube{patches[next], next_eye};
            const auto eyes = geometry.eyes.of(hemicube.patch);
            const EyePoint& eye = eyes[hemicube.eye];
            if (counts && !add_counting(batch, hemicube, eye.share)) {
                break;
            }
            drawer->add(eye, frame(hemicube), static_cast<std::uint32_t>(batch.size()),
                        visibility ? &hemicube.fronts : nullptr);
            batch.push_back(std::move(hemicube));
            if (++next_eye == eyes.size()) {
                next_eye = 0;
                ++next;
            }
        }
        buffers.begin(*drawer, static_cast<std::uint32_t>(batch.size()), counting);
        return batch;
    }

    /// Finds a row of tallies and a table of weights for the next hemicube of a batch; false where there is
    /// none left.
    bool add_counting(const Batch& batch, Hemicube& hemicube, double share) {
        if (!batch.empty()) {
            hemicube.row = batch.back().row + (batch.back().patch == hemicube.patch ? 0 : 1);
        }
        if (hemicube.row == buffers.rows()) {
            return false;
        }
        const auto table = buffers.table(share_key(share), weights_for(share));
        if (table) {
            counting.push_back({*table, hemicube.row});
        }
        return table.has_value();
    }

    [[nodiscard]] EyeFrame frame(const Hemicube& hemicube) const {
        return {geometry.eyes.of(hemicube.patch)[hemicube.eye].normal, hemicube.patch, hemicube.eye,
                settings.seed};
    }

    /// What weights are kept by: shares differ in their last bits, which DeltaFormFactors does not see.
    static std::uint64_t share_key(double share) { return static_cast<std::uint64_t>(share * 0x1p32); }

    /// Weights for an eye point that stands for `share` of its patch; a rule has few different shares.
    const DeltaFormFactors& weights_for(double share) {
        if (share >= 1.0) {
            return weights;
        }
        constexpr std::size_t max_kept = 32;
        const std::uint64_t key = share_key(share);
        const auto found = std::find_if(scaled_weights.begin(), scaled_weights.end(),
                                        [key](const auto& entry) { return entry.first == key; });
        if (found != scaled_weights.end()) {
            return found->second;
        }
        if (scaled_weights.size() == max_kept) {
            scaled_weights.pop_front();
        }
        return scaled_weights.emplace_back(key, weights.scaled(share)).second;
    }

    /// Adds a hemicube to its row; the row itself once it was the last.
    std::optional<RawRow> add(const Hemicube& hemicube, const std::uint32_t* ids, const TexelTally* tallies) {
        const auto eyes = geometry.eyes.of(hemicube.patch);
        const EyePoint& eye = eyes[hemicube.eye];
        const DeltaFormFactors& eye_weights = weights_for(eye.share);
        const bool last = hemicube.eye + 1 == eyes.size();
        if (!visibility) {
            accumulator->add(ids, eye_weights);
            return last ? std::optional(accumulator->take()) : std::nullopt;
        }
        visibility->add(ids, eye_weights);
        if (!counts) {
            visibility->add_hidden(ids, eye_weights, hemicube.fronts, eye, frame(hemicube));
            return last ? std::optional(raw_row(visibility->take())) : std::nullopt;
        }
        return last ? std::optional(raw_row(visibility->take(row_tallies(hemicube, tallies)))) : std::nullopt;
    }

    /// Forgets hemicubes of a row that was not finished.
    void discard() {
        buffers.discard();
        reset(visibility.has_value());
    }

    void reset(bool of_visibility) {
        carried.clear();
        if (of_visibility) {
            visibility.emplace(geometry.list, geometry.patches);
        } else {
            accumulator.emplace(geometry.list.item_of_id, geometry.patches);
        }
    }

    [[nodiscard]] std::span<const TexelTally> tallies_of(const Hemicube& hemicube,
                                                         const TexelTally* tallies) const {
        const std::size_t ids = geometry.list.item_of_id.size();
        return {tallies + hemicube.row * ids, ids};
    }

    /// Keeps the tallies of a batch's last row, which goes on in the next batch.
    void carry(const Batch& batch, const TexelTally* tallies) {
        const Hemicube& last = batch.back();
        if (!counts || last.eye + 1 == geometry.eyes.of(last.patch).size()) {
            return;
        }
        const auto some = tallies_of(last, tallies);
        carried.resize(some.size());
        std::transform(some.begin(), some.end(), carried.begin(), carried.begin(), std::plus<>());
    }

    /// The tallies of a row that ends in this batch.
    std::span<const TexelTally> row_tallies(const Hemicube& last, const TexelTally* tallies) {
        const auto some = tallies_of(last, tallies);
        if (carried.empty()) {
            return some;
        }
        std::transform(some.begin(), some.end(), carried.begin(), carried.begin(), std::plus<>());
        whole.swap(carried);
        carried.clear();
        return whole;
    }

    const EngineGeometry& geometry;
    HemicubeSettings settings;
    DeltaFormFactors weights;
    std::deque<std::pair<std::uint64_t, DeltaFormFactors>> scaled_weights; ///< by share_key()
    std::unique_ptr<gl::Context> own_context; ///< null where the context is another's
    gl::Context* context;
    bool on_gpu; ///< polygons are transformed there
    bool counts; ///< what covers texels is counted there
    ItemBuffers buffers;
    std::unique_ptr<HemicubeDrawer> drawer;
    std::optional<RowAccumulator> accumulator;       ///< of form factors
    std::optional<VisibilityAccumulator> visibility; ///< or of visibility
    std::vector<TexelTally> carried;                 ///< of a row that an earlier batch began
    std::vector<TexelTally> whole;                   ///< of a row of several batches
    std::vector<ItemBuffers::Counting> counting;     ///< of the batch that is being begun
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
            const ItemBuffers::Batch drawn = state.buffers.finish();
            const State::Batch batch = std::move(under_way.front());
            under_way.pop_front();
            for (std::size_t slot = 0; slot < batch.size(); ++slot) {
                if (const auto row = state.add(batch[slot], drawn.ids + slot * texels, drawn.tallies)) {
                    sink(batch[slot].patch, *row);
                }
            }
            state.carry(batch, drawn.tallies);
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
    const std::uint32_t* ids = state_->buffers.finish().ids;
    std::vector<std::uint32_t> items(std::size_t{3} * state_->settings.resolution *
                                     state_->settings.resolution);
    for (std::size_t texel = 0; texel < items.size(); ++texel) {
        items[texel] = state_->geometry.list.item_of_id[ids[texel]];
    }
    state_->buffers.restore_defaults();
    return items;
}

} // namespace hemi
