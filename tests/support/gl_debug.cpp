#include <cstdlib>

namespace {

/// Before any test: every OpenGL context of the tests, and of the programs that they start, records errors
/// (gl::debug_wanted).
[[maybe_unused]] const bool debug_contexts = setenv("HEMI_GL_DEBUG", "1", 1) == 0;

} // namespace
