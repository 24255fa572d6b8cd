#include "gl/reversed_depth.hpp"

namespace hemi::gl {

ReversedDepth::ReversedDepth(GLenum front_face) {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glEnable(GL_CULL_FACE);
    glFrontFace(front_face);
}

ReversedDepth::~ReversedDepth() {
    glDisable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(0.0F, 0.0F);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

void ReversedDepth::cull_fronts() const {
    glCullFace(GL_FRONT);
}

void ReversedDepth::offset(GLfloat slopes, GLfloat units) const {
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(slopes, units);
}

} // namespace hemi::gl
