#include "engine/hemicube/clipped_polygons.hpp"

#include "gl/shaders.hpp"

#include <cstddef>

namespace hemi {

namespace {

gl::Program make_program(std::string_view label, const std::string& fragment) {
    return gl::make_program(label, gl::shaders::hemicube_clipped_vert,
                            gl::with_definition(fragment, "CLIPPED").c_str());
}

} // namespace

ClippedPolygons::ClippedPolygons(const DrawList& list, const Atlas& atlas)
    : atlas_(atlas), views_(list, atlas.slots),
      affine_(make_program("clipped hemicube", gl::shaders::hemicube_frag)),
      bilinear_(make_program("clipped hemicube quads",
                             gl::with_definition(gl::shaders::hemicube_frag, "BILINEAR"))) {
    const auto attribute = [this](GLuint index, GLint count, bool integer, std::size_t offset) {
        glEnableVertexArrayAttrib(layout_.get(), index);
        glVertexArrayAttribBinding(layout_.get(), index, 0);
        const auto at = static_cast<GLuint>(offset);
        if (integer) {
            glVertexArrayAttribIFormat(layout_.get(), index, count, GL_UNSIGNED_INT, at);
        } else {
            glVertexArrayAttribFormat(layout_.get(), index, count, GL_FLOAT, GL_FALSE, at);
        }
    };
    attribute(0, 3, false, offsetof(DrawVertex, x));
    attribute(1, 2, false, offsetof(DrawVertex, grid_u));
    attribute(2, 2, false, offsetof(DrawVertex, twist_u));
    attribute(3, 3, true, offsetof(DrawVertex, first_id));
}

void ClippedPolygons::add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot,
                          FrontViews* fronts) {
    views_.add(eye, frame, slot, stream_, fronts);
}

bool ClippedPolygons::full() const {
    constexpr std::size_t enough_vertices = std::size_t{1} << 20;
    return stream_.size() >= enough_vertices;
}

void ClippedPolygons::draw() {
    glViewport(0, 0, static_cast<GLsizei>(atlas_.resolution),
               static_cast<GLsizei>(3 * atlas_.resolution * atlas_.slots));
    struct Part {
        const std::vector<DrawVertex>& vertices;
        const gl::Program& program;
        bool behind; ///< loses ties in depth
    };
    const std::array<Part, 3> parts{{{stream_.affine, affine_, false},
                                     {stream_.bilinear, bilinear_, false},
                                     {stream_.blocked, affine_, true}}};
    glNamedBufferData(vertices_.get(), static_cast<GLsizeiptr>(stream_.size() * sizeof(DrawVertex)), nullptr,
                      GL_STREAM_DRAW);
    glBindVertexArray(layout_.get());
    glVertexArrayVertexBuffer(layout_.get(), 0, vertices_.get(), 0, sizeof(DrawVertex));
    // Vertices are snapped to a grain of 1/256 texel or so; along a silhouette, where a front hides a back
    // that shares its edge, either may come out nearer by its change of depth over that distance. Fronts are
    // set nearer by it and backs farther: the front wins.
    constexpr float last_places = 16.0f;
    glEnable(GL_POLYGON_OFFSET_FILL);
    std::size_t first = 0;
    for (const Part& part : parts) {
        if (part.vertices.empty()) {
            continue;
        }
        const auto count = part.vertices.size();
        glNamedBufferSubData(vertices_.get(), static_cast<GLintptr>(first * sizeof(DrawVertex)),
                             static_cast<GLsizeiptr>(count * sizeof(DrawVertex)), part.vertices.data());
        glPolygonOffset(part.behind ? -atlas_.grain : atlas_.grain, part.behind ? -last_places : 0.0f);
        glUseProgram(part.program.get());
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(first), static_cast<GLsizei>(count));
        first += count;
    }
    stream_.clear();
}

} // namespace hemi
