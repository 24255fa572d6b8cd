#pragma once

#include "gl/objects.hpp"

// Locations of uniforms, as the shaders declare them. A test reads them back from the linked programs.

/// picture.vert, which has eye, clip_from_direction and clip, with picture.frag, picture_item.frag, which has
/// none, or picture_outline.frag, which has outline_width.
namespace hemi::picture_uniforms {
inline constexpr GLint eye = 0;
inline constexpr GLint clip_from_direction = 1;
inline constexpr GLint flat_shading = 2;
inline constexpr GLint outline_width = 3;
inline constexpr GLint stripe_width = 4;
inline constexpr GLint first_sample = 5;
inline constexpr GLint clip = 6;
inline constexpr GLint line_count = 7;
inline constexpr GLint line_width = 8;
inline constexpr GLint lines = 9;
} // namespace hemi::picture_uniforms

/// resolve.frag
namespace hemi::resolve_uniforms {
inline constexpr GLuint samples_unit = 0; ///< texture unit: the binding of `samples`
inline constexpr GLint samples_per_edge = 1;
inline constexpr GLint target_origin = 2;
inline constexpr GLint exposure = 3;
inline constexpr GLint filmic = 4;
inline constexpr GLint environment = 5;
inline constexpr GLint has_environment = 6;
inline constexpr GLint nothing = 7;
} // namespace hemi::resolve_uniforms
