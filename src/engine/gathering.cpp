#include "engine/gathering.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

namespace hemi {

namespace {

/// Patches whose centres are farther apart than so many times the sum of their radii are taken as points:
/// the factor from centre to centre is then within a few per cent.
constexpr float far_ratio = 2.0F;

} // namespace

Gathering::Gathering(const PatchMesh& mesh, std::uint32_t channels, std::vector<double> radiosity,
                     std::span<const double> environment)
    : Gathering(ImageMesh(mesh), channels, std::move(radiosity), environment) {}

Gathering::Gathering(const ImageMesh& images, std::uint32_t channels, std::vector<double> radiosity,
                     std::span<const double> environment)
    : channels_(channels), radiosity_(std::move(radiosity)),
      environment_(environment.begin(), environment.end()), bright_(images.mesh().size(), 0),
      areas_(images.mesh()) {
    const PatchMesh& mesh = images.mesh();
    environment_.resize(environment.empty() ? channels : environment.size(), 0.0);
    if (channels == 0 || environment_.size() != channels ||
        radiosity_.size() != std::size_t{images.size()} * channels) {
        throw InvalidArgument(
            fmt::format("gathering: {} values for {} patches of {} channels, {} of the environment",
                        radiosity_.size(), images.size(), channels, environment_.size()));
    }
    for (std::uint32_t p = images.size(); p < mesh.size(); ++p) {
        for (std::uint32_t c = 0; c < channels; ++c) {
            radiosity_.push_back(radiosity_[std::size_t{images.original(p)} * channels + c]);
        }
    }
    for (std::size_t k = 0; k < radiosity_.size(); ++k) {
        if (radiosity_[k] > 0.0) {
            bright_[k / channels] = 1;
        }
    }
    places_.reserve(mesh.size());
    const Vec3 middle = mesh.bounds().centre();
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners corners = mesh.corners(i);
        double radius = 0.0;
        for (std::size_t k = 0; k < corners.count; ++k) {
            radius = std::max(radius, glm::distance(corners.points[k], mesh.centres()[i]));
        }
        places_.push_back({glm::vec3(mesh.centres()[i] - middle), static_cast<float>(radius),
                           glm::vec3(mesh.normal(i)), static_cast<float>(mesh.areas()[i])});
    }
}

float Gathering::unoccluded_factor(std::uint32_t i, std::uint32_t j) const {
    const Place& from = places_[i];
    const Place& to = places_[j];
    const glm::vec3 way = to.centre - from.centre;
    const float square = glm::dot(way, way);
    const float reach = far_ratio * (from.radius + to.radius);
    if (square < reach * reach) {
        return static_cast<float>(areas_(i, j)) / from.area;
    }
    // Each divided by the square, so that no scale of the scene is too large or too small for floats.
    const float leaving = std::max(0.0F, glm::dot(from.normal, way)) / square;
    const float arriving = std::max(0.0F, -glm::dot(to.normal, way)) / square;
    return leaving * arriving * to.area * std::numbers::inv_pi_v<float>;
}

template <class Factor>
void Gathering::gather(double environment, std::span<const std::uint32_t> columns, const Factor& factor,
                       std::span<double> irradiance) const {
    for (std::uint32_t c = 0; c < channels_; ++c) {
        irradiance[c] = environment * environment_[c];
    }
    for (std::size_t k = 0; k < columns.size(); ++k) {
        const std::uint32_t j = columns[k];
        const double value = bright_[j] == 0 ? 0.0 : factor(k, j);
        if (value == 0.0) {
            continue;
        }
        const double* const sent = radiosity_.data() + std::size_t{j} * channels_;
        for (std::uint32_t c = 0; c < channels_; ++c) {
            irradiance[c] += value * sent[c];
        }
    }
}

void Gathering::gather(std::uint32_t, const RowView& row, std::span<double> irradiance) const {
    gather(
        row.environment, row.columns,
        [&row](std::size_t k, std::uint32_t) { return static_cast<double>(row.values[k]); }, irradiance);
}

void Gathering::gather(std::uint32_t patch, const VisibilityRow& row, std::span<double> irradiance) const {
    const auto factor = [this, patch, &row](std::size_t k, std::uint32_t j) {
        const auto share = static_cast<double>(row.shares[k]);
        return share == 0.0 ? 0.0 : share * static_cast<double>(unoccluded_factor(patch, j));
    };
    gather(row.environment, row.columns, factor, irradiance);
}

} // namespace hemi
