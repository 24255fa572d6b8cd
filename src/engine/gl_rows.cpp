#include "engine/gl_rows.hpp"

#include "engine/item_buffers.hpp"
#include "engine/row_accumulator.hpp"
#include "engine/view_builder.hpp"
#include "gl/context.hpp"

#include <algorithm>
#include <deque>

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

EngineGeometry make_engine_geometry(const PatchMesh& mesh, bool merge_lattices) {
    return {make_draw_list(mesh, merge_lattices), make_eye_points(mesh)};
}

struct GlRows::State {
    State(const EngineGeometry& the_geometry, const HemicubeSettings& the_settings, const std::string& device)
        : geometry(the_geometry), settings(the_settings), weights(the_settings.resolution),
          context(gl::make_context(device)),
          buffers(*context, settings.resolution, batch_slots(settings.resolution, context->software())),
          views(geometry.list, buffers.slots()),
          accumulator(weights, geometry.list.item_of_id, static_cast<std::uint32_t>(geometry.eyes.size())) {}

    /// Starts as many of `patches` as fit a batch: in slots, and in vertices where the mesh is large.
    std::uint32_t begin_batch(std::span<const std::uint32_t> patches) {
        constexpr std::size_t enough_vertices = std::size_t{1} << 20;
        const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(patches.size(), buffers.slots()));
        std::uint32_t used = 0;
        stream.clear();
        while (used < most && (used == 0 || stream.size() < enough_vertices)) {
            const EyePoint& eye = geometry.eyes[patches[used]];
            views.add(eye, EyeFrame(eye.normal, patches[used], settings.seed), used, stream);
            ++used;
        }
        buffers.begin(stream, used);
        return used;
    }

    const EngineGeometry& geometry;
    HemicubeSettings settings;
    DeltaFormFactors weights;
    std::unique_ptr<gl::Context> context;
    ItemBuffers buffers;
    ViewBuilder views;
    RowAccumulator accumulator;
    DrawStream stream;
};

GlRows::GlRows(const EngineGeometry& geometry, const HemicubeSettings& settings, const std::string& device)
    : state_(std::make_unique<State>(geometry, settings, device)) {}

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

void GlRows::rows(std::span<const std::uint32_t> patches, const RowSink& sink) {
    State& state = *state_;
    state.context->make_current();
    const std::size_t texels = std::size_t{3} * state.settings.resolution * state.settings.resolution;
    std::size_t begun = 0;
    std::size_t done = 0;
    std::deque<std::uint32_t> under_way; // rows in each batch
    try {
        while (done < patches.size()) {
            while (under_way.size() < state.buffers.depth() && begun < patches.size()) {
                under_way.push_back(state.begin_batch(patches.subspan(begun)));
                begun += under_way.back();
            }
            const std::uint32_t* ids = state.buffers.finish();
            const std::uint32_t used = under_way.front();
            under_way.pop_front();
            for (std::uint32_t slot = 0; slot < used; ++slot, ++done) {
                state.accumulator.add(ids + slot * texels);
                sink(patches[done], state.accumulator.take());
            }
        }
    } catch (...) {
        state.buffers.discard(); // a sink that stops must not leave batches behind
        throw;
    }
}

std::vector<std::uint32_t> GlRows::items(std::uint32_t patch) {
    state_->context->make_current();
    state_->begin_batch(std::span(&patch, 1));
    const std::uint32_t* ids = state_->buffers.finish();
    std::vector<std::uint32_t> items(std::size_t{3} * state_->settings.resolution *
                                     state_->settings.resolution);
    for (std::size_t texel = 0; texel < items.size(); ++texel) {
        items[texel] = state_->geometry.list.item_of_id[ids[texel]];
    }
    return items;
}

} // namespace hemi
