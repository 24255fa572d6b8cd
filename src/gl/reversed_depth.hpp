#pragma once

#include <glad/gl.h>

namespace hemi::gl {

/// State for drawing what is nearest, while it lives: clip z is 1 at the near plane and 0 at infinity, the
/// greater depth wins, and back faces are culled. Expects OpenGL's default state, and leaves it behind.
class ReversedDepth {
public:
    /// @param front_face  how front faces turn on the screen: GL_CCW or GL_CW
    explicit ReversedDepth(GLenum front_face);
    ~ReversedDepth();
    ReversedDepth(const ReversedDepth&) = delete;
    ReversedDepth& operator=(const ReversedDepth&) = delete;

    /// Culls front faces from now on, instead of back faces.
    void cull_fronts() const;
    /// Sets what is drawn from now on nearer, or farther if negative, as glPolygonOffset does.
    void offset(GLfloat slopes, GLfloat units) const;
};

} // namespace hemi::gl
