#include "io/meshes/tessellation.hpp"

#include "core/box_tree.hpp"
#include "hemi/scene/scene.hpp"

#include <GL/glu.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <utility>

// GLU's tessellator is plain geometry: no OpenGL function is called, and no context is needed.
namespace hemi::io {

namespace {

constexpr std::size_t most_corners = 10'000; // takes time by their square, at worst
using Corners = std::array<std::size_t, 3>;

/// Points of a polygon, as it has them and in the plane that it is seen in, about one in size.
struct Points {
    std::vector<Vec3> at;
    std::vector<Vec3> seen; ///< z = 0
    Vec3 origin{0.0};
    Vec3 right{0.0};
    Vec3 up{0.0};

    Points(std::span<const Vec3> outline) {
        const Vec3 normal = glm::normalize(area_vector(outline));
        Bounds bounds;
        for (const Vec3& point : outline) {
            bounds.add(point);
        }
        const Vec3 other = std::abs(normal.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 across = glm::normalize(glm::cross(other, normal));
        origin = outline[0];
        right = across / bounds.diagonal();
        up = glm::cross(normal, right);
    }

    void add(const Vec3& point) {
        at.push_back(point);
        seen.emplace_back(glm::dot(point - origin, right), glm::dot(point - origin, up), 0.0);
    }
};

/// What the tessellator tells.
struct Triangles {
    Points& points;
    std::vector<std::size_t> corners;
    bool failed = false;
    std::exception_ptr thrown; ///< by a callback: no exception may pass through the tessellator's C
};

Triangles& triangles_of(void* user) {
    return *static_cast<Triangles*>(user);
}

// A point is passed as its number from 1: none is a null pointer.
void* number_of(std::size_t index) {
    return reinterpret_cast<void*>(index + 1);
}
std::size_t index_of(const void* number) {
    return reinterpret_cast<std::uintptr_t>(number) - 1;
}

/// Calls a function that may throw for want of memory; after that, no other.
template <class Function>
void guard(void* user, const Function& function) noexcept {
    Triangles& triangles = triangles_of(user);
    if (triangles.thrown) {
        return;
    }
    try {
        function(triangles);
    } catch (...) {
        triangles.thrown = std::current_exception();
    }
}

void take_vertex(void* number, void* user) noexcept {
    guard(user, [number](Triangles& triangles) { triangles.corners.push_back(index_of(number)); });
}

/// Two edges meet: where corners of theirs lie upon each other, the corner is that of both.
void take_combined(GLdouble place[3], void* numbers[4], GLfloat weights[4], void** result,
                   void* user) noexcept {
    *result = numbers[0];
    guard(user, [&](Triangles& triangles) {
        Points& points = triangles.points;
        Vec3 point(0.0);
        for (int k = 0; k < 4; ++k) {
            if (numbers[k] == nullptr) {
                continue;
            }
            const std::size_t index = index_of(numbers[k]);
            if (std::hypot(points.seen[index].x - place[0], points.seen[index].y - place[1]) < 1e-9) {
                *result = numbers[k];
                return;
            }
            point += static_cast<double>(weights[k]) * points.at[index];
        }
        points.at.push_back(point);
        points.seen.emplace_back(place[0], place[1], 0.0);
        *result = number_of(points.at.size() - 1);
    });
}

void take_edge_flag(GLboolean, void*) noexcept {} // with it, all is single triangles

void take_error(GLenum error, void* user) noexcept {
    triangles_of(user).failed = true;
    if (error == GLU_OUT_OF_MEMORY) {
        guard(user, [](Triangles&) { throw std::bad_alloc(); });
    }
}

template <class Function>
_GLUfuncptr callback(Function* function) {
    return reinterpret_cast<_GLUfuncptr>(function);
}

double twice_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    return glm::cross(b - a, c - a).z;
}

/// Whether edges of contours cross each other more often than there are corners, for which the tessellator
/// would take time by the cube of their number. @param ends  of the contours' points
bool crosses_itself_often(const Points& points, std::span<const std::size_t> ends) {
    const std::vector<Vec3>& seen = points.seen;
    std::vector<Bounds> boxes(seen.size());
    std::vector<std::size_t> next(seen.size());
    std::size_t first = 0;
    for (const std::size_t end : ends) {
        for (std::size_t k = first; k < end; ++k) {
            next[k] = k + 1 < end ? k + 1 : first;
            boxes[k].add(seen[k]);
            boxes[k].add(seen[next[k]]);
        }
        first = end;
    }
    const BoxTree tree(boxes);
    const auto parts = [&](std::size_t edge, std::size_t other) { // the ends of the other, clearly
        constexpr double clearly = 1e-12;
        const double a = twice_area(seen[edge], seen[next[edge]], seen[other]);
        const double b = twice_area(seen[edge], seen[next[edge]], seen[next[other]]);
        return std::min(a, b) < -clearly && std::max(a, b) > clearly;
    };
    std::size_t crossings = 0;
    for (std::size_t k = 0; k < seen.size() && crossings <= seen.size(); ++k) {
        tree.overlapping(boxes[k], [&](std::uint32_t other) {
            crossings += other > k && parts(k, other) && parts(other, k) ? 1 : 0;
        });
    }
    return crossings > seen.size();
}

/// Pairs of triangles at their longest common edges become quadrilaterals.
void join(const Points& points, std::span<const Corners> triangles, std::vector<PolygonPiece>& pieces) {
    struct Side {
        std::size_t triangle;
        std::size_t corner; ///< that is not on the edge
    };
    std::map<std::pair<std::size_t, std::size_t>, std::vector<Side>> sides;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto ends = std::minmax(triangles[t][(c + 1) % 3], triangles[t][(c + 2) % 3]);
            sides[ends].push_back({t, c});
        }
    }
    struct Shared {
        double length;
        Side a;
        Side b;
    };
    std::vector<Shared> shared;
    for (const auto& [ends, both] : sides) {
        if (both.size() == 2) {
            shared.push_back(
                {glm::distance(points.seen[ends.first], points.seen[ends.second]), both[0], both[1]});
        }
    }
    std::stable_sort(shared.begin(), shared.end(),
                     [](const Shared& a, const Shared& b) { return a.length > b.length; });
    std::vector<bool> used(triangles.size(), false);
    for (const Shared& edge : shared) {
        if (used[edge.a.triangle] || used[edge.b.triangle]) {
            continue;
        }
        const Corners& first = triangles[edge.a.triangle];
        const std::size_t c = edge.a.corner;
        const PolygonPiece quad{{points.at[first[c]], points.at[first[(c + 1) % 3]],
                                 points.at[triangles[edge.b.triangle][edge.b.corner]],
                                 points.at[first[(c + 2) % 3]]},
                                4};
        if (!polygon_defect({quad.points.data(), 4})) {
            used[edge.a.triangle] = used[edge.b.triangle] = true;
            pieces.push_back(quad);
        }
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (!used[t]) {
            pieces.push_back({{points.at[triangles[t][0]], points.at[triangles[t][1]],
                               points.at[triangles[t][2]], Vec3(0.0)},
                              3});
        }
    }
}

} // namespace

std::optional<std::string> tessellate(std::span<const Vec3> outline, std::span<const std::vector<Vec3>> holes,
                                      std::vector<PolygonPiece>& pieces) {
    Points points(outline);
    std::size_t corners = outline.size();
    for (const std::vector<Vec3>& hole : holes) {
        corners += hole.size();
    }
    if (corners > most_corners) {
        return fmt::format("{} corners of a polygon that is not convex; there can be {}", corners,
                           most_corners);
    }
    // All points first, since the tessellator adds some where edges cross.
    std::vector<std::size_t> ends;
    double wanted = 0.0;
    const auto add_contour = [&](auto begin, auto end) {
        const std::size_t first = points.at.size();
        std::for_each(begin, end, [&](const Vec3& point) { points.add(point); });
        ends.push_back(points.at.size());
        double twice = 0.0;
        for (std::size_t k = first; k + 2 < points.at.size(); ++k) {
            twice += twice_area(points.seen[first], points.seen[k + 1], points.seen[k + 2]);
        }
        return twice;
    };
    wanted += add_contour(outline.begin(), outline.end());
    for (const std::vector<Vec3>& hole : holes) {
        const bool turns_left = glm::dot(area_vector(hole), area_vector(outline)) > 0.0;
        wanted +=
            turns_left ? add_contour(hole.rbegin(), hole.rend()) : add_contour(hole.begin(), hole.end());
    }

    const char* const crossed = holes.empty()
                                    ? "edges that cross each other"
                                    : "edges that cross each other, or a hole that does not lie in it";
    if (crosses_itself_often(points, ends)) {
        return crossed;
    }
    const std::unique_ptr<GLUtesselator, decltype(&gluDeleteTess)> tessellator(gluNewTess(), &gluDeleteTess);
    if (!tessellator) {
        throw std::bad_alloc();
    }
    Triangles result{points, {}, false, nullptr};
    GLUtesselator* const tess = tessellator.get();
    gluTessCallback(tess, GLU_TESS_VERTEX_DATA, callback(&take_vertex));
    gluTessCallback(tess, GLU_TESS_COMBINE_DATA, callback(&take_combined));
    gluTessCallback(tess, GLU_TESS_EDGE_FLAG_DATA, callback(&take_edge_flag));
    gluTessCallback(tess, GLU_TESS_ERROR_DATA, callback(&take_error));
    gluTessProperty(tess, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_POSITIVE);
    gluTessNormal(tess, 0.0, 0.0, 1.0);
    gluTessBeginPolygon(tess, &result);
    std::size_t next = 0;
    for (const std::size_t end : ends) {
        gluTessBeginContour(tess);
        for (; next < end; ++next) {
            std::array<GLdouble, 3> place{points.seen[next].x, points.seen[next].y, 0.0};
            gluTessVertex(tess, place.data(), number_of(next));
        }
        gluTessEndContour(tess);
    }
    gluTessEndPolygon(tess);
    if (result.thrown) {
        std::rethrow_exception(result.thrown);
    }

    std::vector<Corners> triangles;
    double twice = 0.0;
    for (std::size_t k = 0; k + 2 < result.corners.size(); k += 3) {
        const Corners triangle{result.corners[k], result.corners[k + 1], result.corners[k + 2]};
        twice += twice_area(points.seen[triangle[0]], points.seen[triangle[1]], points.seen[triangle[2]]);
        if (!has_no_area(
                std::array{points.at[triangle[0]], points.at[triangle[1]], points.at[triangle[2]]})) {
            triangles.push_back(triangle);
        }
    }
    // Any crossing adds to the area that is covered, or takes from it.
    if (result.failed || !(std::abs(twice - wanted) <= 1e-7 * std::abs(wanted))) {
        return crossed;
    }
    join(points, triangles, pieces);
    return std::nullopt;
}

} // namespace hemi::io
