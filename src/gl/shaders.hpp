#pragma once

namespace hemi::gl::shaders {

// Sources under shaders/, embedded at build time; file name with '.' as '_'.
extern const char* const hemicube_vert;
extern const char* const hemicube_clipped_vert;
extern const char* const hemicube_frag;
extern const char* const picture_vert;
extern const char* const picture_frag;
extern const char* const picture_item_frag;
extern const char* const picture_outline_frag;
extern const char* const fullscreen_vert;
extern const char* const resolve_frag;

} // namespace hemi::gl::shaders
