#include "engine/hemicube/gpu_polygons.hpp"

#include "engine/hemicube/draw_triangles.hpp"
#include "engine/hemicube/grid_map.hpp"
#include "gl/shaders.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace hemi {

/// Vertex of a triangle as the shaders read it.
struct PolygonVertex {
    SplitPosition position;
    std::uint32_t polygon;
};

namespace {

/// A polygon as the shaders read it: Polygon of hemicube.vert.
struct PolygonRecord {
    std::array<double, 4> plane;
    std::uint32_t front_id, back_id;
    std::uint32_t grid;
    std::uint32_t flags;
    std::uint32_t grid_map;
    std::uint32_t unused;
    float twist_u, twist_v;
};
static_assert(sizeof(PolygonRecord) == 64);
static_assert(offsetof(FaceView, eye_low) == 64 && offsetof(FaceView, own_polygon) == 76 &&
              offsetof(FaceView, grain) == 100);

/// GridMap of hemicube.vert.
struct GridMapRecord {
    std::array<double, 4> u, v;
};

constexpr std::uint32_t no_grid_map = 0xFFFFFFFFu;
constexpr std::size_t cluster_size = 64; ///< triangles that are culled together
constexpr int clip_planes = 4;

gl::Program make_program(bool count_covered) {
    std::string fragment = gl::shaders::hemicube_frag;
    if (count_covered) {
        fragment = gl::with_definition(fragment, "COUNT_COVERED");
    }
    return gl::make_program("hemicube", gl::shaders::hemicube_vert, fragment.c_str());
}

std::array<float, 3> to_float(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// The planes that bound the faces' pyramids, as differences of axes of the eye's frame: a position p is
/// below plane k where normal[k] · p < 0.
class PyramidPlanes {
public:
    explicit PyramidPlanes(const EyeFrame& frame) {
        const std::array<Vec3, count> normals{frame.z - frame.x,
                                              frame.z + frame.x,
                                              frame.z - frame.y,
                                              frame.z + frame.y,
                                              frame.x - frame.y,
                                              frame.x + frame.y,
                                              frame.z};
        for (std::size_t k = 0; k < count; ++k) {
            normals_[k] = to_float(normals[k]);
        }
    }

    /// Faces whose pyramids a box may reach into: bit per face.
    /// @param centre  relative to the eye. @param extent  half edges
    [[nodiscard]] std::uint32_t faces_of(const std::array<float, 3>& centre,
                                         const std::array<float, 3>& extent) const {
        constexpr float rounding = 2e-6f;
        std::uint32_t below = 0; // planes that all of the box is below
        std::uint32_t above = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const auto& n = normals_[k];
            const float at = n[0] * centre[0] + n[1] * centre[1] + n[2] * centre[2];
            const float reach = std::abs(n[0]) * extent[0] + std::abs(n[1]) * extent[1] +
                                std::abs(n[2]) * extent[2] + rounding;
            below |= (at < -reach ? 1u : 0u) << k;
            above |= (at > reach ? 1u : 0u) << k;
        }
        std::uint32_t faces = 0;
        for (std::uint32_t face = 0; face < hemicube_faces; ++face) {
            const bool outside = (below & outside_below[face]) != 0 || (above & outside_above[face]) != 0;
            faces |= outside ? 0u : 1u << face;
        }
        return faces;
    }

private:
    static constexpr std::size_t count = 7;
    enum Plane : std::uint32_t {
        z_minus_x = 1,
        z_plus_x = 2,
        z_minus_y = 4,
        z_plus_y = 8,
        x_minus_y = 16,
        x_plus_y = 32,
        z = 64,
    };
    /// What is wholly below, or above, one of these planes is outside the face.
    static constexpr std::array<std::uint32_t, hemicube_faces> outside_below{
        z_minus_x | z_plus_x | z_minus_y | z_plus_y | z,
        x_minus_y | x_plus_y | z, // +x: x >= z, x >= |y|
        x_plus_y | z,             // +y
        z,                        // -x
        x_minus_y | z,            // -y
    };
    static constexpr std::array<std::uint32_t, hemicube_faces> outside_above{
        0, z_minus_x, z_minus_y | x_minus_y, z_plus_x | x_minus_y | x_plus_y, z_plus_y | x_plus_y,
    };

    std::array<std::array<float, 3>, count> normals_{};
};

} // namespace

GpuPolygons::GpuPolygons(const DrawList& list, const Atlas& atlas, bool count_covered)
    : list_(list), atlas_(atlas), coordinates_(list), program_(make_program(count_covered)) {
    std::vector<DrawTriangle> triangles;
    for (std::uint32_t p = 0; p < list.polygons.size(); ++p) {
        add_triangles(list, p, triangles);
    }
    std::vector<PolygonVertex> vertices;
    vertices.reserve(3 * triangles.size());
    const auto add_cluster = [&](std::span<const DrawTriangle> some) {
        CulledCluster cluster;
        cluster.first_vertex = static_cast<std::uint32_t>(vertices.size());
        cluster.vertices = static_cast<std::uint32_t>(3 * some.size());
        Bounds bounds;
        for (const DrawTriangle& triangle : some) {
            for (const std::uint32_t vertex : triangle.vertices) {
                vertices.push_back({coordinates_.split(list.vertices[vertex]), triangle.polygon});
                bounds.add(coordinates_.of(list.vertices[vertex]));
            }
        }
        cluster.centre = to_float(bounds.centre());
        cluster.extent = to_float(0.5 * (bounds.upper - bounds.lower));
        clusters_.push_back(cluster);
    };
    for_each_cluster(
        std::span(triangles), cluster_size, place_of, [](std::span<const DrawTriangle>) { return true; },
        add_cluster);
    upload(vertices);
}

void GpuPolygons::upload(std::span<const PolygonVertex> vertices) {
    std::vector<PolygonRecord> polygons;
    std::vector<GridMapRecord> maps;
    polygons.reserve(list_.polygons.size());
    for (std::uint32_t p = 0; p < list_.polygons.size(); ++p) {
        const DrawPolygon& polygon = list_.polygons[p];
        const Vec3 on_plane = coordinates_.of(list_.vertices[list_.corners[polygon.first_corner].vertex]);
        PolygonRecord& record = polygons.emplace_back();
        record.plane = {polygon.normal.x, polygon.normal.y, polygon.normal.z,
                        glm::dot(polygon.normal, on_plane)};
        record.front_id = polygon.front_id;
        record.back_id = polygon.back_id;
        record.grid = polygon.grid.u | polygon.grid.v << 16;
        record.flags = polygon.split | polygon.bilinear << 1;
        record.twist_u = polygon.twist_u;
        record.twist_v = polygon.twist_v;
        record.grid_map = no_grid_map;
        if (!polygon.shows_one_id()) {
            const GridMap map = make_grid_map(list_, p);
            const auto in_raster = [&](const Vec3& gradient, double at_origin) {
                const Vec3 g = gradient / coordinates_.scale;
                return std::array{g.x, g.y, g.z,
                                  at_origin + glm::dot(gradient, coordinates_.origin - map.origin)};
            };
            record.grid_map = static_cast<std::uint32_t>(maps.size());
            maps.push_back({in_raster(map.gradient_u, map.u), in_raster(map.gradient_v, map.v)});
        }
    }
    GLint64 largest_block = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest_block);
    if (static_cast<GLint64>(polygons.size() * sizeof(PolygonRecord)) > largest_block) {
        throw GlError(fmt::format("{} polygons to draw; this device holds {}", polygons.size(),
                                  static_cast<std::size_t>(largest_block) / sizeof(PolygonRecord)));
    }
    if (maps.empty()) {
        maps.emplace_back(); // a buffer of no bytes is an error
    }
    const auto fill = [](const gl::Buffer& buffer, const char* name, const auto& content) {
        glNamedBufferStorage(buffer.get(), static_cast<GLsizeiptr>(content.size() * sizeof(content[0])),
                             content.data(), 0);
        gl::label(GL_BUFFER, buffer.get(), name);
    };
    fill(vertices_, "polygon vertices", vertices);
    fill(polygons_, "polygons", polygons);
    fill(grid_maps_, "polygon grids", maps);
    const auto attribute = [this](GLuint index, GLint floats, std::size_t offset) {
        const auto at = static_cast<GLuint>(offset);
        glEnableVertexArrayAttrib(layout_.get(), index);
        glVertexArrayAttribBinding(layout_.get(), index, 0);
        if (floats > 0) {
            glVertexArrayAttribFormat(layout_.get(), index, floats, GL_FLOAT, GL_FALSE, at);
        } else {
            glVertexArrayAttribIFormat(layout_.get(), index, 1, GL_UNSIGNED_INT, at);
        }
    };
    attribute(0, 3, offsetof(PolygonVertex, position) + offsetof(SplitPosition, high));
    attribute(1, 3, offsetof(PolygonVertex, position) + offsetof(SplitPosition, low));
    attribute(2, 0, offsetof(PolygonVertex, polygon));
    glVertexArrayVertexBuffer(layout_.get(), 0, vertices_.get(), 0, sizeof(PolygonVertex));
}

void GpuPolygons::cull(const EyeFrame& frame, const SplitPosition& eye) {
    const PyramidPlanes planes(frame);
    faces_of_.resize(clusters_.size());
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
        const CulledCluster& cluster = clusters_[c];
        std::array<float, 3> centre{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            centre[axis] = cluster.centre[axis] - eye.high[axis];
        }
        faces_of_[c] = static_cast<std::uint8_t>(planes.faces_of(centre, cluster.extent));
    }
}

/// Ranges of the clusters that a face may show; those that follow one another become one.
void GpuPolygons::add_ranges(int face) {
    bool open = false;
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
        if ((faces_of_[c] & (1u << face)) == 0) {
            open = false;
            continue;
        }
        const auto count = static_cast<GLsizei>(clusters_[c].vertices);
        if (open) {
            count_.back() += count;
        } else {
            first_.push_back(static_cast<GLint>(clusters_[c].first_vertex));
            count_.push_back(count);
        }
        open = true;
    }
    range_end_.push_back(first_.size());
}

void GpuPolygons::add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot,
                      FrontViews* /*fronts*/) {
    const SplitPosition position = coordinates_.split(eye.position);
    FaceView view;
    view.eye_high = position.high;
    view.eye_low = position.low;
    const PolygonRange own = list_.polygons_at(eye.surface);
    view.own_polygon = own.first;
    view.own_count = own.count;
    view.texel = 2.0f / static_cast<float>(atlas_.resolution);
    view.tolerance = static_cast<float>(list_.tolerance * coordinates_.scale);
    view.near = 0.5f * view.tolerance; // what comes nearer lies on the eye, and is not drawn
    view.grain = atlas_.grain * view.texel;
    cull(frame, position);
    for (int face = 0; face < hemicube_faces; ++face) {
        const Vec3 depth = face_direction(face, 0.0, 0.0);
        const auto in_world = [&frame](const Vec3& v) {
            return to_float(v.x * frame.x + v.y * frame.y + v.z * frame.z);
        };
        view.right = in_world(face_direction(face, 1.0, 0.0) - depth);
        view.up = in_world(face_direction(face, 0.0, 1.0) - depth);
        view.depth = in_world(depth);
        const std::uint32_t half = atlas_.resolution / 2;
        view.first_row = (6 * slot + static_cast<std::uint32_t>(face)) * half;
        views_.push_back(view);
        add_ranges(face);
    }
}

void GpuPolygons::draw() {
    glNamedBufferData(view_block_.get(), static_cast<GLsizeiptr>(views_.size() * sizeof(FaceView)),
                      views_.data(), GL_STREAM_DRAW);
    glBindVertexArray(layout_.get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, polygons_.get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, grid_maps_.get());
    glUseProgram(program_.get());
    glDisable(GL_CULL_FACE); // the fragments know which way a polygon must turn
    glEnable(GL_SCISSOR_TEST);
    for (int plane = 0; plane < clip_planes; ++plane) {
        glEnable(static_cast<GLenum>(GL_CLIP_DISTANCE0 + plane));
    }
    const auto width = static_cast<GLsizei>(atlas_.resolution);
    std::size_t begin = 0;
    for (std::size_t k = 0; k < views_.size(); ++k) {
        const std::size_t end = range_end_[k];
        if (begin == end) {
            continue;
        }
        // A side is the upper half of a square; the lower one lies below the horizon.
        const bool top = k % hemicube_faces == 0;
        const auto row = static_cast<GLint>(views_[k].first_row);
        glViewport(0, row, width, width);
        glScissor(0, top ? row : row + width / 2, width, top ? width : width / 2);
        glBindBufferRange(GL_UNIFORM_BUFFER, 0, view_block_.get(),
                          static_cast<GLintptr>(k * sizeof(FaceView)), sizeof(FaceView));
        glMultiDrawArrays(GL_TRIANGLES, first_.data() + begin, count_.data() + begin,
                          static_cast<GLsizei>(end - begin));
        begin = end;
    }
    for (int plane = 0; plane < clip_planes; ++plane) {
        glDisable(static_cast<GLenum>(GL_CLIP_DISTANCE0 + plane));
    }
    glDisable(GL_SCISSOR_TEST);
    views_.clear();
    range_end_.clear();
    first_.clear();
    count_.clear();
}

} // namespace hemi
