#include "io/meshes/face_mender.hpp"

#include "hemi/core/text.hpp"
#include "hemi/scene/scene.hpp"
#include "io/meshes/tessellation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi::io {

namespace {

constexpr double largest_coordinate = 1e70; // as polygon_defect() has it; here before areas are taken
constexpr double plane_enough = 1e-5;       // for polygon_defect()

double rounding_of(std::span<const Vec3> points) {
    double magnitude = 0.0;
    for (const Vec3& point : points) {
        magnitude = std::max({magnitude, std::abs(point.x), std::abs(point.y), std::abs(point.z)});
    }
    return 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

/// Takes out corners that repeat the one before, and the tips of edges that go out and the same way back.
void drop_repeated(std::vector<Vec3>& corners) {
    const double rounding = rounding_of(corners);
    std::vector<Vec3> kept;
    const auto same = [rounding](const Vec3& a, const Vec3& b) { return glm::distance(a, b) <= rounding; };
    for (const Vec3& corner : corners) {
        if (!kept.empty() && same(corner, kept.back())) {
            continue;
        }
        if (kept.size() > 1 && same(corner, kept[kept.size() - 2])) {
            kept.pop_back();
            continue;
        }
        kept.push_back(corner);
    }
    std::span<const Vec3> rest = kept;
    for (bool changed = true; changed && rest.size() > 2;) {
        changed = true;
        if (same(rest.front(), rest.back())) {
            rest = rest.first(rest.size() - 1);
        } else if (same(rest.front(), rest[rest.size() - 2])) {
            rest = rest.first(rest.size() - 2);
        } else if (same(rest.back(), rest[1])) {
            rest = rest.subspan(2);
        } else {
            changed = false;
        }
    }
    corners.assign(rest.begin(), rest.end());
}

bool all_in_a_line(std::span<const Vec3> corners) {
    if (corners.empty()) {
        return true;
    }
    Vec3 farthest = corners[0];
    for (const Vec3& corner : corners) {
        if (glm::distance(corner, corners[0]) > glm::distance(farthest, corners[0])) {
            farthest = corner;
        }
    }
    const Vec3 line = farthest - corners[0];
    const double slack = std::max(rounding_of(corners), 1e-9 * glm::length(line));
    return std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
        return glm::length(glm::cross(line, corner - corners[0])) <= slack * glm::length(line);
    });
}

/// How far the corners are off the mean plane, and what that is measured by.
struct Flatness {
    Vec3 normal;
    Vec3 centre;
    double off = 0.0;
    double size = 0.0; ///< longest edge; of more than four corners, the extent

    explicit Flatness(std::span<const Vec3> corners)
        : normal(glm::normalize(area_vector(corners))), centre(area_centroid(corners)) {
        Bounds bounds;
        for (std::size_t k = 0; k < corners.size(); ++k) {
            off = std::max(off, std::abs(glm::dot(corners[k] - centre, normal)));
            size = std::max(size, glm::distance(corners[k], corners[(k + 1) % corners.size()]));
            bounds.add(corners[k]);
        }
        size = corners.size() > 4 ? bounds.diagonal() : size;
    }
};

using Halves = std::array<std::array<Vec3, 3>, 2>;

Halves cut(std::span<const Vec3> quad, std::size_t from) {
    return {
        {{quad[from], quad[from + 1], quad[from + 2]}, {quad[from + 2], quad[(from + 3) % 4], quad[from]}}};
}

/// The triangles on either side of the diagonal that lies in the quadrilateral; where both do, of the one
/// that bends it less, else of the shorter one. Nothing where none does: the outline crosses itself.
std::optional<Halves> cut_along_diagonal(std::span<const Vec3> quad, const Vec3& normal) {
    struct Choice {
        bool inside;
        double bend; ///< 1 - cosine of the angle between the triangles
        double length;
    };
    std::array<Choice, 2> choices{};
    for (std::size_t from = 0; from < 2; ++from) {
        const Halves halves = cut(quad, from);
        const Vec3 first = area_vector(halves[0]);
        const Vec3 second = area_vector(halves[1]);
        choices[from] = {!has_no_area(halves[0]) && !has_no_area(halves[1]) &&
                             glm::dot(first, normal) > 0.0 && glm::dot(second, normal) > 0.0,
                         1.0 - glm::dot(glm::normalize(first), glm::normalize(second)),
                         glm::distance(quad[from], quad[from + 2])};
    }
    if (!choices[0].inside && !choices[1].inside) {
        return std::nullopt;
    }
    if (choices[0].inside != choices[1].inside) {
        return cut(quad, choices[0].inside ? 0 : 1);
    }
    const double bends = choices[1].bend - choices[0].bend;
    const bool alike = std::abs(bends) <= 1e-6 * std::max(choices[0].bend, choices[1].bend) + 1e-12;
    const bool first = alike ? choices[0].length <= choices[1].length * (1.0 + 1e-9) : bends > 0.0;
    return cut(quad, first ? 0 : 1);
}

bool is_convex(std::span<const Vec3> quad, const Vec3& normal) {
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 turn = glm::cross(quad[k] - quad[(k + 3) % 4], quad[(k + 1) % 4] - quad[k]);
        if (glm::dot(turn, normal) < 0.0) {
            return false;
        }
    }
    return true;
}

} // namespace

FaceMender::FaceMender(const SceneReaderOptions& options, std::string noun)
    : strict_(options.strict), planarity_(options.planarity), noun_(std::move(noun)) {}

void FaceMender::Count::add(const Where& where) {
    if (count++ == 0) {
        first = where();
    }
}

std::optional<std::string> FaceMender::take_corners(std::span<const Vec3> face) {
    pieces_.clear();
    for (const Vec3& corner : face) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!(std::abs(corner[axis]) < largest_coordinate)) {
                return fmt::format("coordinate {}; must be finite and below {:g} in size", corner[axis],
                                   largest_coordinate);
            }
        }
    }
    corners_.assign(face.begin(), face.end());
    drop_repeated(corners_);
    return std::nullopt;
}

std::optional<std::string> FaceMender::mend(std::span<const Vec3> face, const Where& where) {
    if (auto defect = take_corners(face)) {
        return defect;
    }
    if (has_no_area(corners_)) {
        if (strict_) {
            return "zero area";
        }
        if (!all_in_a_line(corners_)) {
            return "zero area, since its edges cross each other";
        }
        without_area_.add(where);
        return std::nullopt;
    }
    return corners_.size() > 4 ? mend_polygon(where) : mend_quadrilateral(where);
}

std::optional<std::string> FaceMender::mend(std::span<const Vec3> face,
                                            std::span<const std::vector<Vec3>> holes, const Where& where) {
    if (holes.empty()) {
        return mend(face, where);
    }
    std::vector<std::vector<Vec3>> cleaned;
    for (const std::vector<Vec3>& hole : holes) {
        if (auto defect = take_corners(hole)) {
            return "a hole: " + *defect;
        }
        if (has_no_area(corners_)) {
            if (strict_) {
                return "a hole of zero area";
            }
            without_area_.add(where);
            continue;
        }
        cleaned.push_back(corners_);
    }
    if (auto defect = take_corners(face)) {
        return defect;
    }
    if (has_no_area(corners_)) {
        return "zero area";
    }
    if (!make_plane(where)) {
        return "not planar, which a face with holes must be";
    }
    const Flatness flat(corners_);
    for (std::vector<Vec3>& hole : cleaned) {
        for (Vec3& corner : hole) {
            const double off = glm::dot(corner - flat.centre, flat.normal);
            if (std::abs(off) > std::max(planarity_, plane_enough) * flat.size + rounding_of(corners_)) {
                return fmt::format("a hole that is {:.3g} off the face's plane", std::abs(off));
            }
            corner -= off * flat.normal;
        }
    }
    std::vector<PolygonPiece> parts;
    if (auto defect = tessellate(corners_, cleaned, parts)) {
        return defect;
    }
    for (const PolygonPiece& part : parts) {
        add({part.points.data(), part.count});
    }
    return std::nullopt;
}

/// Or a triangle, which is plane.
std::optional<std::string> FaceMender::mend_quadrilateral(const Where& where) {
    auto defect = polygon_defect(corners_);
    if (corners_.size() == 3) {
        if (!defect) {
            add(corners_);
        }
        return defect;
    }
    if (!defect && planarity_ >= plane_enough) {
        add(corners_);
        return std::nullopt;
    }
    const bool is_plane = make_plane(where);
    defect = polygon_defect(corners_);
    if (is_plane && !defect) {
        add(corners_);
        return std::nullopt;
    }
    if (!is_plane && strict_) {
        return defect ? defect : "not planar";
    }
    const Vec3 normal = glm::normalize(area_vector(corners_));
    const auto halves = cut_along_diagonal(corners_, normal);
    if (!halves) {
        return "edges that cross each other";
    }
    (is_plane || !is_convex(corners_, normal) ? not_convex_ : not_plane_).add(where);
    for (const auto& half : *halves) {
        add(half);
    }
    return std::nullopt;
}

std::optional<std::string> FaceMender::mend_polygon(const Where& where) {
    const bool is_plane = make_plane(where);
    if (!is_plane && strict_) {
        return "not planar";
    }
    if (is_plane && !many_corners_defect(corners_)) {
        std::vector<PolygonPiece> strips;
        cut_into_pieces(corners_, strips);
        for (const PolygonPiece& strip : strips) {
            add({strip.points.data(), strip.count});
        }
        many_corners_.add(where);
        return std::nullopt;
    }
    std::vector<PolygonPiece> parts;
    if (auto defect = tessellate(corners_, {}, parts)) {
        return defect;
    }
    for (const PolygonPiece& part : parts) {
        add({part.points.data(), part.count});
    }
    (is_plane ? not_convex_ : not_plane_).add(where);
    return std::nullopt;
}

/// Whether the corners are in one plane. Those that are nearly, by the planarity that is asked for, are moved
/// into it.
bool FaceMender::make_plane(const Where& where) {
    const Flatness flat(corners_);
    const double rounding = rounding_of(corners_);
    if (flat.off > planarity_ * flat.size + rounding) {
        return false;
    }
    if (flat.off > plane_enough * flat.size + rounding) {
        for (Vec3& corner : corners_) {
            corner -= glm::dot(corner - flat.centre, flat.normal) * flat.normal;
        }
        flattened_.add(where);
    }
    return true;
}

/// A quadrilateral piece of a nearly plane face may itself be less plane, for its size.
void FaceMender::add(std::span<const Vec3> piece) {
    if (piece.size() == 4 && polygon_defect(piece)) {
        if (const auto halves = cut_along_diagonal(piece, glm::normalize(area_vector(piece)))) {
            add((*halves)[0]);
            add((*halves)[1]);
            return;
        }
    }
    PolygonPiece& added = pieces_.emplace_back();
    std::copy(piece.begin(), piece.end(), added.points.begin());
    added.count = static_cast<std::uint32_t>(piece.size());
}

void FaceMender::tell(const std::string& file, Diagnostics& diagnostics) const {
    const auto warn = [&](const Count& of, const std::string& what) {
        if (of.count == 0) {
            return;
        }
        const std::string faces = fmt::format("{} {}", plural(of.count, noun_, noun_ + "s"), what);
        diagnostics.warn(of.first.line > 0
                             ? fmt::format("{}:{}: {}, the first one here", file, of.first.line, faces)
                             : fmt::format("{}: {}, the first one is {}", file, faces, of.first.name));
    };
    warn(without_area_, "without area left out");
    warn(flattened_, fmt::format("off plane by up to {:g} of the size moved into the plane", planarity_));
    warn(not_plane_, "out of plane cut into triangles");
    warn(not_convex_, fmt::format("that {} not convex cut into triangles and quadrilaterals",
                                  not_convex_.count == 1 ? "is" : "are"));
    warn(many_corners_, "of more than 4 vertices cut into quadrilaterals and triangles");
}

} // namespace hemi::io
