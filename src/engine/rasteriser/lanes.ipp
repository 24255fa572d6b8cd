// Compiled once for each instruction set, by rasteriser.cpp: included again when HWY_TARGET_TOGGLE changes.
#if defined(HEMI_RASTERISER_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef HEMI_RASTERISER_LANES
#undef HEMI_RASTERISER_LANES
#else
#define HEMI_RASTERISER_LANES
#endif

#include "engine/rasteriser/raster_scene.hpp"
#include "engine/rasteriser/texel_tiles.hpp"

#include <hwy/highway.h>

#include <array>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace hemi::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Ids = hn::RebindToUnsigned<Floats>;
using Vec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
constexpr Floats floats;
constexpr Ints ints;
constexpr Ids ids_of;
constexpr std::uint32_t lanes = HWY_LANES(float) < 16 ? HWY_LANES(float) : 16;
constexpr std::uint32_t tile_size = TexelTiles::tile_size;
constexpr std::size_t cluster_size = RasterScene::cluster_size;
HWY_INLINE Vec set(float value) {
    return hn::Set(floats, value);
}
/// Bit per lane.
HWY_INLINE std::uint32_t bits_of(Mask mask) {
#if HWY_TARGET == HWY_AVX3
    return static_cast<std::uint32_t>(mask.raw);
#else
    std::array<std::uint8_t, 8> bytes{};
    hn::StoreMaskBits(floats, mask, bytes.data());
    return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
#endif
}
/// Twice the area of (a, b, p), a and b relative to p: positive where p lies left of a -> b. Exactly the
/// negative of the same with a and b exchanged, since nothing is fused.
HWY_INLINE Vec edge(Vec ax, Vec ay, Vec bx, Vec by) {
    return hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx));
}
/// Elements `index` of a table of 64 floats.
HWY_INLINE Vec look_up(const float* table, hn::Vec<Ints> index) {
#if HWY_TARGET == HWY_AVX3
    const __m512 low = _mm512_permutex2var_ps(_mm512_load_ps(table), index.raw, _mm512_load_ps(table + 16));
    const __m512 high =
        _mm512_permutex2var_ps(_mm512_load_ps(table + 32), index.raw, _mm512_load_ps(table + 48));
    return Vec{_mm512_mask_blend_ps(_mm512_test_epi32_mask(index.raw, _mm512_set1_epi32(32)), low, high)};
#else
    return hn::GatherIndex(floats, table, index);
#endif
}
HWY_INLINE hn::Vec<Ints> load_bytes(const std::uint8_t* bytes) {
    return hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint8_t, Ints>(), bytes));
}

template <class T>
using Lanes = std::array<T, lanes>;

} // namespace
} // namespace hemi::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
