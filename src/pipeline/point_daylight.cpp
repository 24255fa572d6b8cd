#include "pipeline/point_daylight.hpp"

#include "hemi/engine/exchange_area.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace hemi {

PointDaylight::PointDaylight(const PatchMesh& mesh, std::optional<Sun> sun, std::optional<Sky> sky, UpAxis up,
                             std::shared_ptr<const SourceClusters> clusters)
    : mesh_(mesh), clusters_(std::move(clusters)), sun_(std::move(sun)), sky_(std::move(sky)),
      up_(upwards(up)), images_(mesh) {
    if (sun_) {
        rays_.emplace(images_.mesh());
    }
    for (std::uint32_t j = 0; j < mesh.size(); ++j) {
        const PatchCorners corners = mesh.corners(j);
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        for (const Vec3& corner : corners.polygon()) {
            low = std::min(low, glm::dot(corner, up_));
            high = std::max(high, glm::dot(corner, up_));
        }
        low_.push_back(low);
        high_.push_back(high);
    }
    if (!clusters_ || !sky_) {
        return;
    }
    const std::span<const SourceClusters::Node> nodes = clusters_->nodes();
    low_.resize(mesh.size() + nodes.size());
    high_.resize(low_.size());
    for (std::size_t k = nodes.size(); k-- > 0;) { // children stand behind their parents
        const std::size_t patch = clusters_->order()[nodes[k].begin];
        const std::size_t first = nodes[k].child == 0 ? patch : mesh.size() + nodes[k].child;
        const std::size_t second = nodes[k].child == 0 ? patch : first + 1;
        low_[mesh.size() + k] = std::min(low_[first], low_[second]);
        high_[mesh.size() + k] = std::max(high_[first], high_[second]);
    }
    centres_.resize(3 * low_.size());
    for (std::size_t j = 0; j < mesh.size(); ++j) {
        for (int axis = 0; axis < 3; ++axis) {
            centres_[3 * j + static_cast<std::size_t>(axis)] = mesh.centres()[j][axis];
        }
    }
    clusters_->fill(centres_, 3);
}

SkyMoments PointDaylight::seen_above(const Vec3& at, const std::optional<Vec3>& normal,
                                     std::uint32_t column) const {
    if (column < mesh_.size()) {
        return seen_above_of_patch(at, normal, column);
    }
    const std::uint32_t cluster = column - mesh_.size();
    const SourceClusters::Node& node = clusters_->nodes()[cluster];
    const double height = glm::dot(at, up_);
    if (high_[column] <= height) {
        return {};
    }
    if (low_[column] >= height) { // in about one direction
        const double* const centre = &centres_[3 * std::size_t{column}];
        const Vec3 way = Vec3(centre[0], centre[1], centre[2]) - at;
        return {1.0, std::max(0.0, glm::dot(way, up_)) / glm::length(way)};
    }
    if (node.child == 0) {
        return seen_above_of_patch(at, normal, clusters_->order()[node.begin]);
    }
    const double first = clusters_->first_share(cluster);
    const std::uint32_t child = mesh_.size() + node.child;
    SkyMoments above = first * seen_above(at, normal, child);
    above += (1.0 - first) * seen_above(at, normal, child + 1);
    return above;
}

SkyMoments PointDaylight::seen_above_of_patch(const Vec3& at, const std::optional<Vec3>& normal,
                                              std::uint32_t patch) const {
    const double height = glm::dot(at, up_);
    const bool all_above = low_[patch] >= height;
    if (all_above && !sky_) {
        return {1.0, 0.0};
    }
    if (high_[patch] <= height) {
        return {};
    }
    const PatchCorners corners = mesh_.corners(patch);
    const std::span<const Vec3> polygon = corners.polygon();
    const double all =
        normal ? point_factor(at, *normal, polygon) : solid_angle(at, polygon) / (4.0 * std::numbers::pi);
    if (!(all > 0.0)) {
        return {all_above ? 1.0 : 0.0, 0.0};
    }
    const SkyMoments above = normal ? sky_behind(at, *normal, polygon, up_) : sky_behind(at, polygon, up_);
    const double share = all_above ? 1.0 : std::min(1.0, above.share / all);
    return {share, std::min(share, above.elevation / all)};
}

PointDaylight::Environment PointDaylight::split(double environment, double blocked,
                                                const SkyMoments& available, const SkyMoments& above) {
    const double patches = std::max(0.0, 1.0 - environment - blocked);
    const double free_above = std::clamp(available.share - above.share, 0.0, available.share);
    const double free_below =
        std::clamp((1.0 - available.share) - (patches - above.share), 0.0, 1.0 - available.share);
    const double free = free_above + free_below;
    const double scale = free > 0.0 ? environment / free : 0.0;
    const double elevation = std::clamp(available.elevation - above.elevation, 0.0, free_above);
    return {{scale * free_above, scale * elevation}, free > 0.0 ? scale * free_below : environment};
}

PointDaylight::Environment PointDaylight::seen_by(const Vec3& at, const std::optional<Vec3>& normal,
                                                  const RowView& row) const {
    SkyMoments above;
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        above += static_cast<double>(row.values[k]) * seen_above(at, normal, row.columns[k]);
    }
    return split(row.environment, row.blocked, available(normal), above);
}

} // namespace hemi
