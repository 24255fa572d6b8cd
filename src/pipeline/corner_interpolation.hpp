#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

/// The interpolated value in the middle of a patch's quarter, from the patch's corner values.
class CornerInterpolation {
public:
    CornerInterpolation(const PatchMesh& mesh, std::vector<float> corners, std::uint32_t channels)
        : mesh_(&mesh), corners_(std::move(corners)), channels_(channels) {}

    /// Of a corner of the patch, 0 to 3.
    [[nodiscard]] double at_corner(std::uint32_t patch, std::uint32_t corner, std::uint32_t channel) const {
        return static_cast<double>(corners_[(std::size_t{patch} * 4 + corner) * channels_ + channel]);
    }

    /// Weights of the corners in the middle of a quarter.
    [[nodiscard]] std::array<double, 4> weights(std::uint32_t patch, const PatchCorners& quarter) const {
        const PatchCorners corners = mesh_->corners(patch);
        // The corner that both have: in slanted patches another one may be nearer to the quarter's centre.
        std::uint32_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t k = 0; k < corners.count; ++k) {
            for (const Vec3& point : quarter.polygon()) {
                if (const double way = glm::distance(corners.points[k], point); way < least) {
                    least = way;
                    nearest = k;
                }
            }
        }
        std::array<double, 4> weights{};
        if (corners.count == 4) {
            weights[nearest] = 9.0 / 16.0;
            weights[(nearest + 1) % 4] = weights[(nearest + 3) % 4] = 3.0 / 16.0;
            weights[(nearest + 2) % 4] = 1.0 / 16.0;
            return weights;
        }
        // The quarter in the middle of a triangle has none of its corners, but half an edge to the nearest.
        const double edge = glm::distance(corners.points[nearest], corners.points[(nearest + 1) % 3]);
        const bool middle = least > 0.1 * edge;
        for (std::uint32_t k = 0; k < 3; ++k) {
            weights[k] = middle ? 1.0 / 3.0 : k == nearest ? 2.0 / 3.0 : 1.0 / 6.0;
        }
        return weights;
    }

    /// Of the corner values about the patch's own value, squared and over the square of the channel's unit:
    /// how fast the field changes in the channel where it does so most. Channels of unit 0 do not count.
    [[nodiscard]] double spread(std::uint32_t patch, const Solution& solution,
                                std::span<const double> units) const {
        double largest = 0.0;
        for (std::uint32_t c = 0; c < channels_; ++c) {
            if (units[c] > 0.0) {
                largest = std::max(largest, square(patch, solution, c) / (units[c] * units[c]));
            }
        }
        return largest;
    }

    /// Of the corner values about the patch's own value in one channel, mean square.
    [[nodiscard]] double square(std::uint32_t patch, const Solution& solution, std::uint32_t channel) const {
        const std::uint32_t count = mesh_->corners(patch).count;
        const double own = solution.radiosity[std::size_t{patch} * channels_ + channel];
        double squares = 0.0;
        for (std::uint32_t k = 0; k < count; ++k) {
            squares += std::pow(at_corner(patch, k, channel) - own, 2.0);
        }
        return squares / count;
    }

    /// Of the patch's own value and the mean of its corners, the difference squared: how fast the change
    /// changes.
    [[nodiscard]] double bend(std::uint32_t patch, const Solution& solution, std::uint32_t channel) const {
        const std::uint32_t count = mesh_->corners(patch).count;
        double difference = -solution.radiosity[std::size_t{patch} * channels_ + channel];
        for (std::uint32_t k = 0; k < count; ++k) {
            difference += at_corner(patch, k, channel) / count;
        }
        return difference * difference;
    }

private:
    const PatchMesh* mesh_;
    std::vector<float> corners_;
    std::uint32_t channels_;
};

} // namespace hemi
