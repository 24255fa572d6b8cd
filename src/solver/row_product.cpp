#include "solver/row_product.hpp"

// One source for all instruction sets: this file is compiled once for each by foreach_target.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/row_product.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>

// Must come after foreach_target.h.
#include "hemi/matrix/source_clusters.hpp"

#include <hwy/highway.h>

#include <utility>

HWY_BEFORE_NAMESPACE();
namespace hemi::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Independent partial sums hide the latency of the additions. Their number decides about the last bits.
constexpr std::size_t partial_sums = 4;

/// Of as many neighbouring channels as the tag has lanes, from `x` on.
template <class Tag>
HWY_INLINE void sum_channels(Tag tag, const RowView& row, const double* x, std::size_t stride, double* sums) {
    const std::uint32_t* const columns = row.columns.data();
    const float* const values = row.values.data();
    const std::size_t count = row.columns.size();
    hn::Vec<Tag> partial[partial_sums] = {hn::Zero(tag), hn::Zero(tag), hn::Zero(tag), hn::Zero(tag)};
    const auto add = [&](std::size_t k, hn::Vec<Tag>& sum) {
        sum = hn::Add(sum, hn::Mul(hn::Set(tag, static_cast<double>(values[k])),
                                   hn::LoadU(tag, x + columns[k] * stride)));
    };
    std::size_t k = 0;
    for (; k + partial_sums <= count; k += partial_sums) {
        add(k, partial[0]);
        add(k + 1, partial[1]);
        add(k + 2, partial[2]);
        add(k + 3, partial[3]);
    }
    for (std::size_t lane = 0; k < count; ++k, ++lane) {
        add(k, partial[lane]);
    }
    hn::StoreU(hn::Add(hn::Add(partial[0], partial[1]), hn::Add(partial[2], partial[3])), tag, sums);
}

void sum_all(const RowView& row, const double* x, std::size_t stride, double* sums) {
    constexpr hn::CappedTag<double, 8> wide;
    constexpr hn::CappedTag<double, 4> narrow;
    std::size_t c = 0;
    for (; c + hn::MaxLanes(wide) <= stride; c += hn::MaxLanes(wide)) {
        sum_channels(wide, row, x + c, stride, sums + c);
    }
    for (; c + hn::MaxLanes(narrow) <= stride; c += hn::MaxLanes(narrow)) {
        sum_channels(narrow, row, x + c, stride, sums + c);
    }
    for (; c < stride; ++c) {
        sum_channels(hn::CappedTag<double, 1>(), row, x + c, stride, sums + c);
    }
}

} // namespace
} // namespace hemi::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hemi {

HWY_EXPORT(sum_all);

ChannelField with_clusters(ChannelField field, const FormFactorMatrix& factors) {
    field.resize(factors.columns());
    fill_clusters(field, factors);
    return field;
}

void fill_clusters(ChannelField& field, const FormFactorMatrix& factors) {
    if (factors.clusters() != nullptr) {
        factors.clusters()->fill(field.values(), field.stride());
    }
}

void row_product(const RowView& row, const ChannelField& x, double* sums) {
    HWY_DYNAMIC_DISPATCH(sum_all)(row, x.patch(0), x.stride(), sums);
}

} // namespace hemi
#endif // HWY_ONCE
