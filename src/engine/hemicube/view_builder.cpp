#include "engine/hemicube/view_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace hemi {

namespace {

// Which side of a plane a vertex is on, for the planes that bound the five pyramids.
enum Side : std::uint8_t {
    z_below_x = 1,
    z_below_minus_x = 2,
    z_below_y = 4,
    z_below_minus_y = 8,
    x_below_y = 16,
    x_below_minus_y = 32,
    z_below_0 = 64,
};

/// A face's pyramid: outside if all vertices are on the named side of one plane. `below` counts vertices
/// below the plane as outside, `above` those that are not below.
struct Pyramid {
    std::uint8_t below;
    std::uint8_t above;
};
constexpr std::array<Pyramid, hemicube_faces> pyramids{{
    {z_below_x | z_below_minus_x | z_below_y | z_below_minus_y, 0},
    {x_below_y | x_below_minus_y | z_below_0, z_below_x},       // +x: x >= z, x >= |y|, z >= 0
    {x_below_minus_y | z_below_0, z_below_y | x_below_y},       // +y: y >= z, y >= |x|
    {z_below_0, z_below_minus_x | x_below_y | x_below_minus_y}, // -x
    {x_below_y | z_below_0, z_below_minus_y | x_below_minus_y}, // -y
}};

/// The face's axes, as face_direction(): right, up and depth of a position in the eye's frame.
Vec3 in_face(int face, const Vec3& p) {
    switch (face) {
    case 0:
        return {p.x, p.y, p.z};
    case 1:
        return {p.y, p.z, p.x};
    case 2:
        return {-p.x, p.z, p.y};
    case 3:
        return {-p.y, p.z, -p.x};
    default:
        return {p.x, p.z, -p.y};
    }
}

} // namespace

ViewBuilder::ViewBuilder(const DrawList& list, std::uint32_t slots) : list_(list), slots_(slots) {}

void ViewBuilder::add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, DrawStream& stream,
                      FrontViews* fronts) {
    transform(eye, frame);
    cull(eye);
    const double scale = 1.0 / near_distance(eye);
    for (const Seen& seen : seen_) {
        emit(seen, scale, slot, stream, fronts);
    }
}

void ViewBuilder::transform(const EyePoint& eye, const EyeFrame& frame) {
    positions_.resize(list_.vertices.size());
    sides_.resize(list_.vertices.size());
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        const Vec3 offset = list_.vertices[v] - eye.position;
        const double x = glm::dot(offset, frame.x);
        const double y = glm::dot(offset, frame.y);
        const double z = glm::dot(offset, frame.z);
        positions_[v] = Vec3(x, y, z);
        sides_[v] = static_cast<std::uint8_t>((z < x ? z_below_x : 0) | (z < -x ? z_below_minus_x : 0) |
                                              (z < y ? z_below_y : 0) | (z < -y ? z_below_minus_y : 0) |
                                              (x < y ? x_below_y : 0) | (x < -y ? x_below_minus_y : 0) |
                                              (z < 0.0 ? z_below_0 : 0));
    }
}

void ViewBuilder::cull(const EyePoint& eye) {
    seen_.clear();
    const PolygonRange own = list_.polygons_at(eye.surface);
    for (std::uint32_t p = 0; p < list_.polygons.size(); ++p) {
        const DrawPolygon& polygon = list_.polygons[p];
        const Vec3 to_eye = eye.position - polygon.centre;
        if (own.holds(p) || glm::dot(to_eye, eye.normal) > polygon.radius) {
            continue;
        }
        const Vec3& on_plane = list_.vertices[list_.corners[polygon.first_corner].vertex];
        const double height = glm::dot(eye.position - on_plane, polygon.normal);
        if (std::abs(height) <= list_.tolerance) {
            continue; // edge-on
        }
        std::uint8_t all_below = 0xFF;
        std::uint8_t any_below = 0;
        double highest = -std::numeric_limits<double>::infinity();
        for (std::uint32_t c = 0; c < polygon.corner_count; ++c) {
            const std::uint32_t v = list_.corners[polygon.first_corner + c].vertex;
            all_below &= sides_[v];
            any_below |= sides_[v];
            highest = std::max(highest, positions_[v].z);
        }
        if (highest <= list_.tolerance) {
            continue; // on or behind the eye's plane
        }
        std::uint32_t faces = 0;
        for (std::uint32_t face = 0; face < hemicube_faces; ++face) {
            const Pyramid& pyramid = pyramids[face];
            const bool outside = (all_below & pyramid.below) != 0 || (pyramid.above & ~any_below) != 0;
            faces |= outside ? 0u : 1u << face;
        }
        if (faces != 0) {
            seen_.push_back({p, faces, height < 0.0});
        }
    }
}

double ViewBuilder::near_distance(const EyePoint& eye) const {
    // Face depth is at least distance / sqrt(3); half the distance to the nearest drawn polygon is safe.
    double nearest = std::numeric_limits<double>::infinity();
    std::array<Vec3, 3> triangle;
    for (const Seen& seen : seen_) {
        const DrawPolygon& polygon = list_.polygons[seen.polygon];
        if (glm::length(polygon.centre - eye.position) - polygon.radius >= nearest) {
            continue;
        }
        for (std::uint32_t t = 0; t < polygon.triangle_count; ++t) {
            const auto& corners = list_.triangles[polygon.first_triangle + t];
            for (std::size_t k = 0; k < 3; ++k) {
                triangle[k] = list_.vertices[list_.corners[polygon.first_corner + corners[k]].vertex];
            }
            nearest = std::min(nearest, distance_to_polygon(eye.position, triangle));
        }
    }
    // Only a polygon that passes through the eye itself comes nearer than rounding.
    return 0.5 * std::max(nearest, list_.tolerance);
}

void ViewBuilder::clip(int face) {
    // Signed distances to the four sides of the pyramid; a cut vertex is put exactly on the side.
    const auto distance = [face](int side, const FaceVertex& v) {
        switch (side) {
        case 0:
            return v.depth - v.right;
        case 1:
            return v.depth + v.right;
        case 2:
            return v.depth - v.up;
        default:
            return face == 0 ? v.depth + v.up : v.up;
        }
    };
    for (int side = 0; side < 4 && !clipped_.empty(); ++side) {
        scratch_.clear();
        for (std::size_t k = 0; k < clipped_.size(); ++k) {
            const FaceVertex& here = clipped_[k];
            const FaceVertex& next = clipped_[k + 1 < clipped_.size() ? k + 1 : 0];
            const double d_here = distance(side, here);
            const double d_next = distance(side, next);
            if (d_here >= 0.0) {
                scratch_.push_back(here);
            }
            if ((d_here >= 0.0) == (d_next >= 0.0)) {
                continue;
            }
            // The polygon on the other side of this edge runs it the other way: compute in one fixed order.
            const bool swap =
                std::tie(next.right, next.up, next.depth) < std::tie(here.right, here.up, here.depth);
            const FaceVertex& a = swap ? next : here;
            const FaceVertex& b = swap ? here : next;
            const double d_a = swap ? d_next : d_here;
            const double d_b = swap ? d_here : d_next;
            const double t = d_a / (d_a - d_b);
            FaceVertex cut{a.right + t * (b.right - a.right), a.up + t * (b.up - a.up),
                           a.depth + t * (b.depth - a.depth), a.grid_u + t * (b.grid_u - a.grid_u),
                           a.grid_v + t * (b.grid_v - a.grid_v)};
            if (side < 2) {
                cut.right = side == 0 ? cut.depth : -cut.depth;
            } else if (side == 2) {
                cut.up = cut.depth;
            } else {
                cut.up = face == 0 ? -cut.depth : 0.0;
            }
            scratch_.push_back(cut);
        }
        std::swap(clipped_, scratch_);
    }
}

void ViewBuilder::record(const Seen& seen, int face, FrontViews& fronts) const {
    if (clipped_.size() < 3) {
        return;
    }
    fronts.views.push_back({seen.polygon, static_cast<std::uint32_t>(face), seen.back,
                            static_cast<std::uint32_t>(fronts.points.size()),
                            static_cast<std::uint32_t>(clipped_.size())});
    const auto put = [&](const FaceVertex& v) {
        fronts.points.push_back({v.right / v.depth, v.up / v.depth});
    };
    if (seen.back) {
        std::for_each(clipped_.rbegin(), clipped_.rend(), put);
    } else {
        std::for_each(clipped_.begin(), clipped_.end(), put);
    }
}

void ViewBuilder::emit(const Seen& seen, double scale, std::uint32_t slot, DrawStream& stream,
                       FrontViews* fronts) {
    const DrawPolygon& polygon = list_.polygons[seen.polygon];
    const std::uint32_t first_id = seen.back ? polygon.back_id : polygon.front_id;
    const bool blocked = first_id == item_blocked;
    DrawVertex vertex{};
    vertex.first_id = first_id;
    vertex.grid = blocked ? (1u | 1u << 16) : (polygon.grid.u | polygon.grid.v << 16);
    vertex.split = blocked ? 0 : polygon.split;
    vertex.twist_u = polygon.twist_u;
    vertex.twist_v = polygon.twist_v;
    std::vector<DrawVertex>& out = blocked                 ? stream.blocked
                                   : polygon.bilinear != 0 ? stream.bilinear
                                                           : stream.affine;
    // An outline with corners along its edges is clipped triangle by triangle: a fan would lose them.
    const bool whole = polygon.corner_count <= 4;
    const std::uint32_t pieces = whole ? 1 : polygon.triangle_count;
    for (int face = 0; face < hemicube_faces; ++face) {
        if ((seen.faces & (1u << face)) == 0) {
            continue;
        }
        // Rows in the atlas: the top face's middle, the lower edges of the sides.
        const double rows = 6.0 * slots_; // in half resolutions
        const double middle = 6.0 * slot + (face == 0 ? 1.0 : 1.0 + face);
        const double up_scale = 2.0 / rows;
        const double offset = 2.0 * middle / rows - 1.0;
        for (std::uint32_t piece = 0; piece < pieces; ++piece) {
            clipped_.clear();
            const std::uint32_t count = whole ? polygon.corner_count : 3;
            for (std::uint32_t k = 0; k < count; ++k) {
                const std::uint32_t c = whole ? k : list_.triangles[polygon.first_triangle + piece][k];
                const OutlineCorner& corner = list_.corners[polygon.first_corner + c];
                const Vec3 at = in_face(face, positions_[corner.vertex]);
                clipped_.push_back({at.x, at.y, at.z, corner.grid_u, corner.grid_v});
            }
            clip(face);
            if (fronts != nullptr && !blocked) {
                record(seen, face, *fronts);
            }
            const auto put = [&](const FaceVertex& v) {
                vertex.x = static_cast<float>(v.right * scale);
                vertex.y = static_cast<float>((v.up * up_scale + v.depth * offset) * scale);
                vertex.w = static_cast<float>(v.depth * scale);
                vertex.grid_u = static_cast<float>(v.grid_u);
                vertex.grid_v = static_cast<float>(v.grid_v);
                out.push_back(vertex);
            };
            // All triangles turn the same way on the screen. One that OpenGL finds turned the other way is a
            // sliver that snapping to 1/256 texel has flipped over its silhouette: it is culled.
            for (std::size_t k = 2; k < clipped_.size(); ++k) {
                put(clipped_[0]);
                put(clipped_[seen.back ? k : k - 1]);
                put(clipped_[seen.back ? k - 1 : k]);
            }
        }
    }
}

} // namespace hemi
