#include "scene/enclosed_space.hpp"

#include "core/welder.hpp"
#include "scene/convex_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

namespace hemi {

namespace {

/// Part of an edge of a face, between neighbouring corners of any faces.
struct EdgePart {
    std::uint32_t low;
    std::uint32_t high;
    std::uint32_t face;

    [[nodiscard]] bool same_place(const EdgePart& other) const {
        return low == other.low && high == other.high;
    }
};

/// Corners of a face as numbers of points, with those of other faces that lie on its edges.
std::vector<std::uint32_t> with_points_between(const std::vector<std::uint32_t>& corners,
                                               const std::vector<Vec3>& points, const BoxTree& tree,
                                               double slack) {
    std::vector<std::uint32_t> all;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const std::uint32_t from = corners[k];
        const std::uint32_t to = corners[(k + 1) % corners.size()];
        all.push_back(from);
        const Vec3 way = points[to] - points[from];
        const double length = glm::length(way);
        if (!(length > 0.0)) {
            continue;
        }
        std::vector<std::pair<double, std::uint32_t>> between;
        tree.overlapping(bounds_of(std::array{points[from], points[to]}, slack), [&](std::uint32_t index) {
            const Vec3 offset = points[index] - points[from];
            const double along = glm::dot(offset, way) / length;
            if (index != from && index != to && along > 0.0 && along < length &&
                glm::length(offset - along / length * way) <= slack) {
                between.emplace_back(along, index);
            }
        });
        std::sort(between.begin(), between.end());
        for (const auto& [along, index] : between) {
            all.push_back(index);
        }
    }
    return all;
}

/// Leaves out, again and again, faces of which a part of an edge is of no other: what is left has none.
class FreeFaces {
public:
    /// @param parts  sorted by place; must outlive this
    /// @param faces  number of all
    FreeFaces(const std::vector<EdgePart>& parts, std::size_t faces)
        : parts_(parts), parts_of_(faces), count_(parts.size()), first_(parts.size()), left_out_(faces) {
        for (std::size_t k = 0; k < parts.size(); ++k) {
            first_[k] = k > 0 && parts[k].same_place(parts[k - 1]) ? first_[k - 1] : k;
            ++count_[first_[k]];
            parts_of_[parts[k].face].push_back(k);
        }
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (count_[first_[k]] == 1) {
                leave_out(parts[k].face);
            }
        }
        while (!next_.empty()) {
            const std::uint32_t face = next_.back();
            next_.pop_back();
            for (const std::size_t part : parts_of_[face]) {
                if (--count_[first_[part]] == 1) {
                    leave_out(last_at(first_[part]));
                }
            }
        }
    }

    /// Whether a face was left out.
    [[nodiscard]] bool operator()(std::uint32_t face) const { return left_out_[face]; }

private:
    void leave_out(std::uint32_t face) {
        if (!left_out_[face]) {
            left_out_[face] = true;
            next_.push_back(face);
        }
    }
    /// The face at a place that is not left out yet, or any.
    [[nodiscard]] std::uint32_t last_at(std::size_t first) const {
        std::size_t k = first;
        while (left_out_[parts_[k].face] && k + 1 < parts_.size() &&
               parts_[k + 1].same_place(parts_[first])) {
            ++k;
        }
        return parts_[k].face;
    }

    const std::vector<EdgePart>& parts_;
    std::vector<std::vector<std::size_t>> parts_of_; ///< of every face
    std::vector<std::uint32_t> count_; ///< at the first part of every place: faces that are left
    std::vector<std::size_t> first_;   ///< of every part: the first at the same place
    std::vector<bool> left_out_;       ///< for every face
    std::vector<std::uint32_t> next_;  ///< left out, but still counted
};

/// Of sets that are joined.
class Sets {
public:
    explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::uint32_t index) {
        while (parent_[index] != index) {
            index = parent_[index] = parent_[parent_[index]];
        }
        return index;
    }
    void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

private:
    std::vector<std::uint32_t> parent_;
};

/// Whether a ray from a point meets a triangle.
bool meets(const Vec3& point, const Vec3& direction, const std::array<Vec3, 3>& corners) {
    const Vec3 a = corners[1] - corners[0];
    const Vec3 b = corners[2] - corners[0];
    const Vec3 p = glm::cross(direction, b);
    const double determinant = glm::dot(a, p);
    if (determinant == 0.0) {
        return false;
    }
    const Vec3 offset = point - corners[0];
    const double u = glm::dot(offset, p) / determinant;
    const Vec3 q = glm::cross(offset, a);
    const double v = glm::dot(direction, q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && glm::dot(b, q) / determinant > 0.0;
}

} // namespace

EnclosedSpace::EnclosedSpace(const PatchMesh& mesh)
    : mesh_(mesh), slack_(std::max(1e-7 * mesh.bounds().diagonal(), mesh.rounding())) {
    Welder welder(slack_);
    std::vector<std::vector<std::uint32_t>> corners;
    for (const Surface& surface : mesh.surfaces()) {
        std::vector<std::uint32_t>& of_face = corners.emplace_back();
        for (const Vec3& vertex : surface.polygon()) {
            of_face.push_back(welder.add(vertex));
        }
    }
    std::vector<Bounds> places;
    for (const Vec3& point : welder.points()) {
        places.push_back({point, point});
    }
    const BoxTree tree(places);
    for (std::vector<std::uint32_t>& of_face : corners) {
        of_face = with_points_between(of_face, welder.points(), tree, slack_);
    }
    add_closed_bodies(corners, false);
    add_closed_bodies(corners, true);
    std::vector<Bounds> boxes;
    for (const Triangle& triangle : triangles_) {
        boxes.push_back(bounds_of(triangle.corners));
    }
    tree_.emplace(boxes);
}

/// @param corners  of all faces, with what lies on their edges
/// @param merge    faces of the same corners to one
void EnclosedSpace::add_closed_bodies(const std::vector<std::vector<std::uint32_t>>& corners, bool merge) {
    std::vector<std::uint32_t> faces(corners.size());
    std::iota(faces.begin(), faces.end(), 0u);
    if (merge) {
        std::vector<std::vector<std::uint32_t>> sorted = corners;
        for (std::vector<std::uint32_t>& one : sorted) {
            std::sort(one.begin(), one.end());
        }
        std::stable_sort(faces.begin(), faces.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return sorted[a] < sorted[b]; });
        faces.erase(std::unique(faces.begin(), faces.end(),
                                [&](std::uint32_t a, std::uint32_t b) { return sorted[a] == sorted[b]; }),
                    faces.end());
        if (faces.size() == corners.size()) {
            return; // the same as without
        }
    }
    std::vector<EdgePart> parts;
    for (const std::uint32_t face : faces) {
        const std::vector<std::uint32_t>& of_face = corners[face];
        for (std::size_t k = 0; k < of_face.size(); ++k) {
            const auto [low, high] = std::minmax({of_face[k], of_face[(k + 1) % of_face.size()]});
            if (low != high) {
                parts.push_back({low, high, face});
            }
        }
    }
    std::sort(parts.begin(), parts.end(), [](const EdgePart& a, const EdgePart& b) {
        return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
    });
    const FreeFaces free(parts, corners.size());
    std::erase_if(parts, [&](const EdgePart& part) { return free(part.face); });
    Sets sets(corners.size());
    for (std::size_t k = 1; k < parts.size(); ++k) {
        if (parts[k].same_place(parts[k - 1])) {
            sets.join(parts[k].face, parts[k - 1].face);
        }
    }
    std::vector<bool> closed(corners.size(), true); // of the set of every face
    for (std::size_t first = 0, end = 0; first < parts.size(); first = end) {
        while (end < parts.size() && parts[end].same_place(parts[first])) {
            ++end;
        }
        if ((end - first) % 2 != 0) {
            closed[sets.find(parts[first].face)] = false;
        }
    }
    for (const std::uint32_t face : faces) {
        const std::uint32_t set = sets.find(face);
        if (free(face) || !closed[set]) {
            continue;
        }
        const auto polygon = mesh_.surfaces()[face].polygon();
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
            triangles_.push_back({{polygon[0], polygon[k], polygon[k + 1]}, bodies_ + set});
        }
    }
    bodies_ += static_cast<std::uint32_t>(corners.size());
}

/// Bodies whose faces a ray meets an odd number of times, ascending.
std::vector<std::uint32_t> EnclosedSpace::bodies_around(const Vec3& point, const Vec3& direction) const {
    std::vector<std::uint32_t> met;
    tree_->along(point, direction, [&](std::uint32_t index) {
        if (meets(point, direction, triangles_[index].corners)) {
            met.push_back(triangles_[index].body);
        }
    });
    std::sort(met.begin(), met.end());
    std::vector<std::uint32_t> odd;
    for (std::size_t first = 0, end = 0; first < met.size(); first = end) {
        end = static_cast<std::size_t>(std::upper_bound(met.begin(), met.end(), met[first]) - met.begin());
        if ((end - first) % 2 != 0) {
            odd.push_back(met[first]);
        }
    }
    return odd;
}

bool EnclosedSpace::contains(const Vec3& point) const {
    // Along no edge that people draw. A ray that meets an edge may count it twice or not at all.
    constexpr std::array directions{Vec3(0.5772, 0.7311, 0.3639), Vec3(-0.7853, 0.2718, 0.5563),
                                    Vec3(0.1618, -0.4669, -0.8694)};
    std::vector<std::uint32_t> around;
    for (std::size_t k = 0; k < directions.size() && !empty(); ++k) {
        const std::vector<std::uint32_t> these = bodies_around(point, directions[k]);
        std::vector<std::uint32_t> both;
        std::set_intersection(around.begin(), around.end(), these.begin(), these.end(),
                              std::back_inserter(both));
        around = k == 0 ? these : both;
        if (around.empty()) {
            return false;
        }
    }
    return !around.empty();
}

bool EnclosedSpace::contains_in_front(const Vec3& point, const Vec3& normal, double size) const {
    // Beyond what rounding and welding move, before what stands on the patch.
    const double height = std::max(1e-3 * size, 4.0 * slack_);
    return contains(point + height * normal);
}

bool EnclosedSpace::encloses(std::uint32_t patch) const {
    return contains_in_front(mesh_.centres()[patch], mesh_.normal(patch), std::sqrt(mesh_.areas()[patch]));
}

} // namespace hemi
