#include "benchmark/naive_rows.hpp"

#include "engine/hemicube/draw_list.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/delta_form_factors.hpp"

#include <cstddef>

namespace hemi::bench {

namespace {

constexpr const char* vertex_source = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in uvec2 item; // seen from the front, from the back
layout(location = 0) uniform mat4 clip_from_world;
layout(location = 0) flat out uvec2 item_of_patch;
void main() {
    gl_Position = clip_from_world * vec4(position, 1.0);
    item_of_patch = item;
}
)";

constexpr const char* fragment_source = R"(#version 450 core
layout(location = 0) flat in uvec2 item_of_patch;
layout(location = 0) out uint id;
void main() {
    id = gl_FrontFacing ? item_of_patch.x : item_of_patch.y;
}
)";

struct Vertex {
    std::array<float, 3> position;
    std::array<std::uint32_t, 2> item;
};

} // namespace

std::uint32_t item_of_back(const PatchMesh& mesh, std::uint32_t patch) {
    const std::uint32_t surface = mesh.surface_of()[patch];
    const bool two_sided = mesh.surfaces()[surface].two_sided;
    return two_sided ? item_first_patch + patch + mesh.patches_per_side(surface) : item_blocked;
}

NaiveRows::NaiveRows(const PatchMesh& mesh, const HemicubeSettings& settings, const std::string& device)
    : context_(gl::make_context(device)), settings_(settings), eyes_(make_eye_points(mesh, 1).points),
      near_(1e-4 * mesh.bounds().diagonal()), far_(1.01 * mesh.bounds().diagonal()),
      program_(gl::make_program("naive hemicube", vertex_source, fragment_source)),
      sums_(item_first_patch + mesh.size()) {
    const auto resolution = static_cast<GLsizei>(settings.resolution);
    allocate(top_, resolution, resolution);
    allocate(side_, resolution, resolution / 2);
    upload(mesh);
    set_state();
    const DeltaFormFactors factors(settings.resolution);
    for (std::uint32_t row = 0; row < factors.rows(); ++row) {
        for (std::uint32_t column = 0; column < settings.resolution; ++column) {
            weights_.push_back(factors.weight(row, column));
        }
    }
    ids_.resize(weights_.size());
    gl::check_errors("naive hemicube");
}

NaiveRows::~NaiveRows() {
    try {
        context_->make_current(); // the objects go with it
    } catch (...) {               // nothing left to release into
    }
}

void NaiveRows::allocate(Target& target, GLsizei width, GLsizei height) {
    target.width = width;
    target.height = height;
    glTextureStorage2D(target.ids.get(), 1, GL_R32UI, width, height);
    glTextureStorage2D(target.depth.get(), 1, GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferTexture(target.framebuffer.get(), GL_COLOR_ATTACHMENT0, target.ids.get(), 0);
    glNamedFramebufferTexture(target.framebuffer.get(), GL_DEPTH_ATTACHMENT, target.depth.get(), 0);
    if (glCheckNamedFramebufferStatus(target.framebuffer.get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw GlError("naive hemicube: the driver refuses a framebuffer of R32UI and 32-bit float depth");
    }
}

void NaiveRows::upload(const PatchMesh& mesh) {
    std::vector<Vertex> vertices;
    vertices.reserve(std::size_t{6} * mesh.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        if (mesh.is_back(patch)) {
            continue; // drawn with its front
        }
        const PatchCorners corners = mesh.corners(patch);
        const std::array<std::uint32_t, 2> item{item_first_patch + patch, item_of_back(mesh, patch)};
        for (std::uint32_t k = 2; k < corners.count; ++k) {
            for (const std::uint32_t corner : {0u, k - 1, k}) {
                const Vec3& p = corners.points[corner];
                vertices.push_back(
                    {{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}, item});
            }
        }
    }
    vertex_count_ = static_cast<GLsizei>(vertices.size());
    glNamedBufferStorage(vertices_.get(), static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                         vertices.data(), 0);
    const GLuint layout = layout_.get();
    glVertexArrayVertexBuffer(layout, 0, vertices_.get(), 0, sizeof(Vertex));
    glEnableVertexArrayAttrib(layout, 0);
    glVertexArrayAttribBinding(layout, 0, 0);
    glVertexArrayAttribFormat(layout, 0, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
    glEnableVertexArrayAttrib(layout, 1);
    glVertexArrayAttribBinding(layout, 1, 0);
    glVertexArrayAttribIFormat(layout, 1, 2, GL_UNSIGNED_INT, offsetof(Vertex, item));
}

void NaiveRows::set_state() {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glFrontFace(GL_CW); // the hemicube's faces are seen from within
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
}

void NaiveRows::rows(std::span<const std::uint32_t> patches, const RowSink& sink) {
    context_->make_current();
    glUseProgram(program_.get());
    glBindVertexArray(layout_.get());
    for (const std::uint32_t patch : patches) {
        draw_hemicube(patch);
        for (std::size_t texel = 0; texel < ids_.size(); ++texel) {
            sums_[ids_[texel]] += weights_[texel];
        }
        sink(patch, take_row());
    }
    gl::check_errors("naive hemicube");
}

void NaiveRows::draw_hemicube(std::uint32_t patch) {
    const EyePoint& eye = eyes_[patch];
    const EyeFrame frame(eye.normal, patch, 0, settings_.seed);
    std::uint32_t* ids = ids_.data();
    for (int face = 0; face < hemicube_faces; ++face) {
        const Target& target = face == 0 ? top_ : side_;
        draw_face(clip_from_world(eye, frame, face), target, ids);
        ids += std::size_t{settings_.resolution} * static_cast<std::size_t>(target.height);
    }
}

void NaiveRows::draw_face(const std::array<float, 16>& clip_from_world, const Target& target,
                          std::uint32_t* ids) {
    constexpr std::array<GLuint, 4> nothing{item_nothing, 0, 0, 0};
    constexpr GLfloat farthest = 1.0f;
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
    glViewport(0, 0, target.width, target.height);
    glClearNamedFramebufferuiv(target.framebuffer.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(target.framebuffer.get(), GL_DEPTH, 0, &farthest);
    glProgramUniformMatrix4fv(program_.get(), 0, 1, GL_TRUE, clip_from_world.data());
    glDrawArrays(GL_TRIANGLES, 0, vertex_count_);
    glReadPixels(0, 0, target.width, target.height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids);
}

std::array<float, 16> NaiveRows::clip_from_world(const EyePoint& eye, const EyeFrame& frame, int face) const {
    const auto in_world = [&frame](const Vec3& v) { return v.x * frame.x + v.y * frame.y + v.z * frame.z; };
    const Vec3 forward = face_direction(face, 0.0, 0.0);
    const Vec3 depth = in_world(forward);
    const Vec3 right = in_world(face_direction(face, 1.0, 0.0) - forward);
    const Vec3 up = in_world(face_direction(face, 0.0, 1.0) - forward);
    const double z_scale = (far_ + near_) / (far_ - near_);
    const double z_offset = -2.0 * far_ * near_ / (far_ - near_);

    std::array<float, 16> matrix{}; // by rows
    const auto set_row = [&](std::size_t row, const Vec3& axis, double offset) {
        matrix[4 * row] = static_cast<float>(axis.x);
        matrix[4 * row + 1] = static_cast<float>(axis.y);
        matrix[4 * row + 2] = static_cast<float>(axis.z);
        matrix[4 * row + 3] = static_cast<float>(offset - glm::dot(axis, eye.position));
    };
    set_row(0, right, 0.0);
    set_row(1, face == 0 ? up : 2.0 * up - depth, 0.0); // of a side, the upper half
    set_row(2, z_scale * depth, z_offset);
    set_row(3, depth, 0.0);
    return matrix;
}

RowView NaiveRows::take_row() {
    constexpr double unit = 1.0 / DeltaFormFactors::total;
    columns_.clear();
    values_.clear();
    for (std::size_t item = item_first_patch; item < sums_.size(); ++item) {
        if (sums_[item] != 0) {
            columns_.push_back(static_cast<std::uint32_t>(item - item_first_patch));
            values_.push_back(static_cast<float>(sums_[item] * unit));
            sums_[item] = 0;
        }
    }
    const RowView row{.columns = columns_,
                      .values = values_,
                      .environment = sums_[item_nothing] * unit,
                      .blocked = sums_[item_blocked] * unit};
    sums_[item_nothing] = sums_[item_blocked] = 0;
    return row;
}

} // namespace hemi::bench
