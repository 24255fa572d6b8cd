#pragma once

namespace hemi {

/// A patch with a larger blocked share b_i is covered: its eye lies under or inside something. Half and more,
/// less a few texels: the eye may lie exactly on an edge of what covers the rest.
inline constexpr double buried_above = 0.49;

} // namespace hemi
