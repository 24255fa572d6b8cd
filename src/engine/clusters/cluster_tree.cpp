#include "engine/clusters/cluster_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

namespace hemi {

namespace {

/// Largest angle between the normals of a cluster and their mean: patches that look farther apart would be
/// seen at very different angles, and one in the light beside one in the dark.
constexpr double widest_cone = std::numbers::pi / 6.0;

/// Smallest box about a set of points.
struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};

    void add(const Vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    [[nodiscard]] Vec3 size() const { return high - low; }
    [[nodiscard]] int longest() const {
        const Vec3 sides = size();
        return sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
    }
};

double radius_of(const PatchMesh& mesh, std::uint32_t patch) {
    double radius = 0.0;
    const PatchCorners corners = mesh.corners(patch);
    for (const Vec3& corner : corners.polygon()) {
        radius = std::max(radius, glm::distance(corner, mesh.centres()[patch]));
    }
    return radius;
}

double angle_between(const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct Tree {
    std::vector<std::uint32_t> order;
    std::vector<SourceClusters::Node> nodes;
    std::vector<ClusterShape> shapes;
};

class Builder {
public:
    Builder(const PatchMesh& mesh, std::span<const std::uint8_t> apart) : mesh_(mesh), apart_(apart) {
        normals_.reserve(mesh.size());
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            normals_.push_back(mesh.normal(i));
        }
    }

    [[nodiscard]] Tree build() {
        tree_.order.resize(mesh_.size());
        std::iota(tree_.order.begin(), tree_.order.end(), 0u);
        if (mesh_.size() > 0) {
            tree_.nodes.reserve(2 * std::size_t{mesh_.size()});
            tree_.shapes.reserve(2 * std::size_t{mesh_.size()});
            tree_.nodes.push_back({0, mesh_.size(), 0});
            tree_.shapes.emplace_back();
        }
        // The nodes below one lie side by side: whoever goes through the tree finds them near one another.
        std::vector<std::uint32_t> open;
        if (!tree_.nodes.empty()) {
            open.push_back(0);
        }
        while (!open.empty()) {
            const std::uint32_t k = open.back();
            open.pop_back();
            divide(k);
            if (const std::uint32_t child = tree_.nodes[k].child; child != 0) {
                open.push_back(child + 1);
                open.push_back(child);
            }
        }
        for (std::size_t k = tree_.nodes.size(); k-- > 0;) {
            enclose(k);
        }
        return std::move(tree_);
    }

private:
    /// Cone and, unless it is a leaf, children of a node: what stands apart first, then by direction until
    /// its cone is narrow, then by place.
    void divide(std::uint32_t k) {
        const std::uint32_t begin = tree_.nodes[k].begin;
        const std::uint32_t end = tree_.nodes[k].end;
        const std::span<const std::uint32_t> patches = std::span(tree_.order).subspan(begin, end - begin);
        Box normals;
        Box places;
        Vec3 sum(0.0);
        for (const std::uint32_t i : patches) {
            normals.add(normals_[i]);
            places.add(mesh_.centres()[i]);
            sum += normals_[i];
        }
        ClusterShape& shape = tree_.shapes[k];
        shape.axis = glm::length(sum) > 0.0 ? glm::normalize(sum) : normals_[patches.front()];
        shape.cone = 0.0;
        for (const std::uint32_t i : patches) {
            shape.cone = std::max(shape.cone, angle_between(shape.axis, normals_[i]));
        }
        shape.cone_sine = std::sin(shape.cone);
        shape.cone_cosine = std::cos(shape.cone);
        const bool mixed = is_mixed(patches);
        shape.one_direction = shape.cone <= widest_cone && !mixed;
        if (patches.size() == 1) {
            return;
        }
        const std::uint32_t middle = mixed                 ? set_apart(begin, end)
                                     : shape.one_direction ? halve(begin, end, places)
                                                           : part(begin, end, normals);
        tree_.nodes[k].child = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.push_back({begin, middle, 0});
        tree_.nodes.push_back({middle, end, 0});
        tree_.shapes.resize(tree_.nodes.size());
    }

    [[nodiscard]] bool is_mixed(std::span<const std::uint32_t> patches) const {
        return !apart_.empty() && std::any_of(patches.begin(), patches.end(), [&](std::uint32_t i) {
            return apart_[i] != apart_[patches.front()];
        });
    }

    /// Behind all others.
    std::uint32_t set_apart(std::uint32_t begin, std::uint32_t end) {
        const auto found = std::stable_partition(tree_.order.begin() + begin, tree_.order.begin() + end,
                                                 [&](std::uint32_t i) { return apart_[i] == 0; });
        return static_cast<std::uint32_t>(found - tree_.order.begin());
    }

    /// At the median along the longest side: the tree stays flat.
    std::uint32_t halve(std::uint32_t begin, std::uint32_t end, const Box& box) {
        const int axis = box.longest();
        const auto place = [&](std::uint32_t i) { return std::pair(mesh_.centres()[i][axis], i); };
        const std::uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(tree_.order.begin() + begin, tree_.order.begin() + middle, tree_.order.begin() + end,
                         [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
        return middle;
    }

    /// At the middle of the longest side of the box of normals: what looks the same way stays together.
    std::uint32_t part(std::uint32_t begin, std::uint32_t end, const Box& box) {
        const int axis = box.longest();
        const double middle = 0.5 * (box.low[axis] + box.high[axis]);
        const auto found = std::stable_partition(tree_.order.begin() + begin, tree_.order.begin() + end,
                                                 [&](std::uint32_t i) { return normals_[i][axis] < middle; });
        return static_cast<std::uint32_t>(found - tree_.order.begin());
    }

    /// Sphere about a node: that of a leaf holds its patch, another one those of its children.
    void enclose(std::size_t k) {
        ClusterShape& shape = tree_.shapes[k];
        const std::uint32_t child = tree_.nodes[k].child;
        if (child == 0) {
            const std::uint32_t patch = tree_.order[tree_.nodes[k].begin];
            shape.centre = mesh_.centres()[patch];
            shape.radius = radius_of(mesh_, patch);
            return;
        }
        const ClusterShape& a = tree_.shapes[child];
        const ClusterShape& b = tree_.shapes[child + 1];
        const Vec3 way = b.centre - a.centre;
        const double distance = glm::length(way);
        // A little more, so that rounding does not let a part stick out.
        constexpr double margin = 1.0 + 1e-9;
        if (distance <= std::abs(a.radius - b.radius)) {
            const ClusterShape& larger = a.radius >= b.radius ? a : b;
            shape.centre = larger.centre;
            shape.radius = margin * larger.radius;
            return;
        }
        const double radius = 0.5 * (distance + a.radius + b.radius);
        shape.centre = a.centre + way * ((radius - a.radius) / distance);
        shape.radius = margin * radius;
    }

    const PatchMesh& mesh_;
    std::span<const std::uint8_t> apart_;
    std::vector<Vec3> normals_;
    Tree tree_;
};

/// Moments of the nodes: of a patch as of a square, of others what those of their children make up.
std::vector<ClusterMoments> moments_of(const PatchMesh& mesh, const Tree& tree) {
    std::vector<ClusterMoments> moments(tree.nodes.size());
    for (std::size_t k = tree.nodes.size(); k-- > 0;) {
        const SourceClusters::Node& node = tree.nodes[k];
        ClusterMoments& here = moments[k];
        if (node.child == 0) {
            const std::uint32_t patch = tree.order[node.begin];
            here.area = mesh.areas()[patch];
            here.centre = mesh.centres()[patch];
            here.normals = here.area * mesh.normal(patch);
            here.second = here.area * here.area / 6.0;
            continue;
        }
        const ClusterMoments& a = moments[node.child];
        const ClusterMoments& b = moments[node.child + 1];
        here.area = a.area + b.area;
        here.centre = (a.area * a.centre + b.area * b.centre) / here.area;
        here.normals = a.normals + b.normals;
        for (const ClusterMoments* const part : {&a, &b}) {
            const Vec3 offset = part->centre - here.centre;
            here.second += part->second + part->area * glm::dot(offset, offset);
        }
    }
    return moments;
}

} // namespace

bool may_face(const ClusterShape& cluster, const Vec3& at, const std::optional<Vec3>& normal, double reach) {
    const Vec3 way = at - cluster.centre;
    if (normal && glm::dot(way, *normal) >= cluster.radius) {
        return false;
    }
    const double distance = glm::length(way);
    const double size = cluster.radius + reach;
    if (distance <= size) {
        return true;
    }
    // The angle between way and axis is below a right angle, that of the cone, and what the sphere takes, in
    // which sine and cosine of the latter two together are told by what is known of each.
    const double sine = size / distance;
    const double cosine = std::sqrt(1.0 - sine * sine);
    const double widest_cosine = cluster.cone_cosine * cosine - cluster.cone_sine * sine;
    if (widest_cosine <= 0.0) {
        return true; // cone and sphere are a right angle, or more
    }
    return glm::dot(way, cluster.axis) >
           -distance * (cluster.cone_sine * cosine + cluster.cone_cosine * sine);
}

namespace {

ClusterStrata strata_of(std::span<const SourceClusters::Node> nodes, std::uint32_t node) {
    ClusterStrata strata{};
    const auto add = [&](std::uint32_t of) { strata.nodes[strata.count++] = of; };
    const std::uint32_t child = nodes[node].child;
    if (child == 0) {
        add(node);
        return strata;
    }
    for (const std::uint32_t half : {child, child + 1}) {
        if (const std::uint32_t below = nodes[half].child; below != 0) {
            add(below);
            add(below + 1);
        } else {
            add(half);
        }
    }
    return strata;
}

void add_spreads(std::span<const SourceClusters::Node> nodes, std::span<const ClusterShape> shapes,
                 std::vector<ClusterMoments>& moments) {
    for (std::uint32_t k = 0; k < nodes.size(); ++k) {
        double of_middles = 0.0;
        double farthest = 0.0;
        const ClusterStrata strata = strata_of(nodes, k);
        for (const std::uint32_t node : std::span(strata.nodes).first(strata.count)) {
            const Vec3 offset = moments[node].centre - moments[k].centre;
            of_middles += moments[node].area * glm::dot(offset, offset);
            farthest = std::max(farthest, glm::length(offset));
        }
        // Beside a large patch a small one would have to go far for both to have the moment: none leaves the
        // sphere.
        const double spread = of_middles > 0.0 ? std::sqrt(moments[k].second / of_middles) : 1.0;
        moments[k].spread =
            farthest > 0.0 ? std::min(spread, std::max(1.0, shapes[k].radius / farthest)) : 1.0;
    }
}

} // namespace

ClusterStrata ClusterTree::strata(std::uint32_t node) const {
    return strata_of(clusters_->nodes(), node);
}

ClusterTree::ClusterTree(const PatchMesh& mesh, std::span<const std::uint8_t> apart)
    : position_(mesh.size()), leaf_of_(mesh.size()) {
    Tree built = Builder(mesh, apart).build();
    shapes_ = std::move(built.shapes);
    for (std::uint32_t k = 0; k < built.nodes.size(); ++k) {
        if (built.nodes[k].child == 0) {
            const std::uint32_t patch = built.order[built.nodes[k].begin];
            position_[patch] = built.nodes[k].begin;
            leaf_of_[patch] = k;
        }
    }
    moments_ = moments_of(mesh, built);
    add_spreads(built.nodes, shapes_, moments_);
    clusters_ =
        std::make_shared<SourceClusters>(std::move(built.order), std::move(built.nodes), mesh.areas());
}

void ClusterTree::seen_from(std::uint32_t patch, double opening, std::vector<Part>& parts) const {
    const ClusterShape& receiver = shapes_[leaf_of_[patch]];
    parts.clear();
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const std::uint32_t k = open.back();
        open.pop_back();
        const ClusterShape& shape = shapes_[k];
        const std::uint32_t child = clusters_->nodes()[k].child;
        const double gap = glm::distance(receiver.centre, shape.centre) - (receiver.radius + shape.radius);
        // Both radii: what is near one way is near the other way, too. A part of a far cluster is smaller and
        // not nearer.
        const bool far = shape.one_direction && std::max(receiver.radius, shape.radius) < opening * gap;
        if (far || child == 0) {
            parts.push_back({k, far});
        } else {
            open.push_back(child + 1);
            open.push_back(child);
        }
    }
}

void ClusterTree::seen_from(const Vec3& at, const std::optional<Vec3>& normal, double opening,
                            std::vector<Part>& parts) const {
    parts.clear();
    std::vector<std::uint32_t> open;
    if (!shapes_.empty()) {
        open.push_back(0);
    }
    while (!open.empty()) {
        const std::uint32_t k = open.back();
        open.pop_back();
        const ClusterShape& shape = shapes_[k];
        if (!may_face(shape, at, normal, 0.0)) {
            parts.push_back({k, true, true});
            continue;
        }
        const std::uint32_t child = clusters_->nodes()[k].child;
        const double gap = glm::distance(at, shape.centre) - shape.radius;
        const bool far = shape.one_direction && shape.radius < opening * gap;
        if (far || child == 0) {
            parts.push_back({k, far});
        } else {
            open.push_back(child + 1);
            open.push_back(child);
        }
    }
}

} // namespace hemi
