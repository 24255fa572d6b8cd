#pragma once

#include "hemi/engine/visibility_provider.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>

namespace hemi {

/// What the numbers of a raw row mean.
enum class RowQuantity : std::uint32_t {
    form_factors, ///< values are F(i, j); no visibility
    visibility,   ///< values are the shares of a VisibilityRow, visibility its numbers of texels
};

/// A row as accumulators make it, workers send it and checkpoints store it, whatever it means: one layout, so
/// that shared memory, files and blocks exist once. Users of the engine see RowView or VisibilityRow, which
/// are views of the same memory.
struct RawRow : RowView {
    RawRow() = default;
    RawRow(const RowView& row) : RowView(row) {}

    std::span<const JointVisibility> joint; ///< of a VisibilityRow; neither sent nor stored
    const PatchSets* sets = nullptr;
};
/// Hands out raw rows.
using RawRowProvider = BasicRowProvider<RawRow>;

/// The row as it is stored.
[[nodiscard]] inline RawRow raw_row(const RowView& row) {
    return row;
}
[[nodiscard]] inline RawRow raw_row(const VisibilityRow& row) {
    RawRow raw = RowView{row.columns, row.shares, row.texels, row.environment, row.blocked};
    raw.joint = row.joint;
    raw.sets = row.sets;
    return raw;
}

/// A stored row as what it means: a RowView or a VisibilityRow.
template <class Row>
[[nodiscard]] Row row_from_raw(const RawRow& raw);
template <>
[[nodiscard]] inline RowView row_from_raw(const RawRow& raw) {
    return raw;
}
template <>
[[nodiscard]] inline VisibilityRow row_from_raw(const RawRow& raw) {
    return {raw.columns, raw.values, raw.visibility, raw.environment, raw.blocked, raw.joint, raw.sets};
}

} // namespace hemi
