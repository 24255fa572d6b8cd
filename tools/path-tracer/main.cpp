// Mean irradiance of a scene's groups by tracing paths: true values for tests, from other code than
// hemicubes, form factors and solvers. Run by hand; tests/data/path-traced/README.md says how.

#include "core/parallel_for.hpp"
#include "engine/rays/embree_scene.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/imprint.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace hemi;
using Random = std::mt19937_64;

/// Rays start and end this far from surfaces, in units of the scene's diagonal.
constexpr double clearance = 1e-6;
/// Paths that carry less than this go on with that probability.
constexpr double little = 0.1;
constexpr double survival = 0.5;

double uniform(Random& random) {
    return std::generate_canonical<double, 53>(random);
}

/// A side of a surface that receives light.
struct Side {
    std::uint32_t surface;
    Vec3 normal; ///< outwards
    double area;
};

class PathTracer {
public:
    explicit PathTracer(const Scene& scene)
        : scene_(scene), channels_(scene.channels.size()),
          rays_(scene.bounds(), quads(scene), RTC_SCENE_FLAG_ROBUST),
          clearance_(clearance * scene.bounds().diagonal()), sides_of_group_(scene.groups.size()) {
        for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
            const Surface& surface = scene.surfaces[s];
            const Vec3 area = area_vector(surface.polygon());
            const Side front{s, glm::normalize(area), glm::length(area)};
            add(front);
            if (surface.two_sided) {
                add({s, -front.normal, front.area});
            }
            normals_.push_back(front.normal);
        }
    }

    [[nodiscard]] std::size_t channels() const { return channels_; }

    /// Adds a sample of the mean irradiance of a group: the light that one of its points gets along a path.
    void sample(std::uint32_t group, Random& random, std::vector<double>& light) const {
        const Side* side = &choose(sides_of_group_[group], random);
        Vec3 point = point_on(*side, random);
        Vec3 normal = side->normal;
        std::vector<double> carried(channels_, 1.0);
        for (;;) {
            add_lamps(point, normal, carried, random, light);
            const Vec3 direction = cosine_direction(normal, random);
            const std::optional<std::pair<std::uint32_t, double>> hit = trace(point, normal, direction);
            if (!hit) {
                for (std::size_t c = 0; c < scene_.environment.size(); ++c) {
                    light[c] += carried[c] * scene_.environment[c];
                }
                return;
            }
            const Surface& surface = scene_.surfaces[hit->first];
            const bool back = glm::dot(direction, normals_[hit->first]) > 0.0;
            if (back && !surface.two_sided) {
                return;
            }
            const Vec3 next_normal = back ? -normals_[hit->first] : normals_[hit->first];
            const Material& material = scene_.materials[surface.material];
            const double share =
                1.0 - share_of_lamps(glm::dot(direction, normal), -glm::dot(direction, next_normal),
                                     hit->second * hit->second);
            for (std::size_t c = 0; c < channels_; ++c) {
                light[c] += carried[c] * material.exitance[c] * share;
                carried[c] *= material.reflectance[c];
            }
            point += hit->second * direction;
            normal = next_normal;
            if (const double most = *std::max_element(carried.begin(), carried.end()); most < little) {
                if (most <= 0.0 || uniform(random) >= survival) {
                    return;
                }
                for (double& value : carried) {
                    value /= survival;
                }
            }
        }
    }

private:
    static std::vector<EmbreeScene::Quad> quads(const Scene& scene) {
        std::vector<EmbreeScene::Quad> result;
        for (const Surface& surface : scene.surfaces) {
            result.push_back(EmbreeScene::quad(surface.polygon()));
        }
        return result;
    }

    void add(const Side& side) {
        const Surface& surface = scene_.surfaces[side.surface];
        sides_of_group_[surface.group].push_back(side);
        const std::vector<double>& exitance = scene_.materials[surface.material].exitance;
        if (std::any_of(exitance.begin(), exitance.end(), [](double value) { return value > 0.0; })) {
            lamps_.push_back(side);
            lamp_area_ += side.area;
        }
    }

    /// One of several sides, by area.
    static const Side& choose(const std::vector<Side>& sides, Random& random) {
        double total = 0.0;
        for (const Side& side : sides) {
            total += side.area;
        }
        double at = uniform(random) * total;
        for (const Side& side : sides) {
            at -= side.area;
            if (at < 0.0) {
                return side;
            }
        }
        return sides.back();
    }

    [[nodiscard]] Vec3 point_on(const Side& side, Random& random) const {
        const Surface& surface = scene_.surfaces[side.surface];
        const auto& v = surface.vertices;
        const auto area = [&](std::size_t b, std::size_t c) {
            return glm::length(glm::cross(v[b] - v[0], v[c] - v[0]));
        };
        std::size_t second = 1; // the triangle of 0, second and the one after it
        if (surface.vertex_count == 4 && uniform(random) * (area(1, 2) + area(2, 3)) >= area(1, 2)) {
            second = 2;
        }
        double a = uniform(random);
        double b = uniform(random);
        if (a + b > 1.0) {
            a = 1.0 - a;
            b = 1.0 - b;
        }
        return v[0] + a * (v[second] - v[0]) + b * (v[second + 1] - v[0]);
    }

    static Vec3 cosine_direction(const Vec3& normal, Random& random) {
        const double radius = std::sqrt(uniform(random));
        const double angle = 2.0 * std::numbers::pi * uniform(random);
        const Vec3 across = glm::normalize(
            glm::cross(normal, std::abs(normal.x) < 0.6 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0)));
        return radius * std::cos(angle) * across + radius * std::sin(angle) * glm::cross(normal, across) +
               std::sqrt(1.0 - radius * radius) * normal;
    }

    /// Lamps are met in two ways, by a path as it goes on and by choosing a point of theirs. Both count, in
    /// the ratio of their probabilities, so that neither has rare large values: this is the share of the
    /// second (balance heuristic; E. Veach, 1997).
    /// @param cosine   at the point that receives
    /// @param at_lamp  cosine there
    [[nodiscard]] double share_of_lamps(double cosine, double at_lamp, double squared_distance) const {
        const double by_path = cosine / std::numbers::pi * at_lamp / squared_distance; // for an area
        const double by_lamp = lamp_area_ > 0.0 ? 1.0 / lamp_area_ : 0.0;
        return by_lamp / (by_lamp + std::max(0.0, by_path));
    }

    /// Light of a random point of a lamp.
    void add_lamps(const Vec3& point, const Vec3& normal, const std::vector<double>& carried, Random& random,
                   std::vector<double>& light) const {
        if (lamps_.empty()) {
            return;
        }
        const Side& lamp = choose(lamps_, random);
        const Vec3 there = point_on(lamp, random);
        const Vec3 to_lamp = there - point;
        const double square = glm::dot(to_lamp, to_lamp);
        const double cosines = glm::dot(to_lamp, normal) * -glm::dot(to_lamp, lamp.normal) / square;
        if (glm::dot(to_lamp, normal) <= 0.0 || cosines <= 0.0 ||
            is_hidden(point + clearance_ * normal, there + clearance_ * lamp.normal)) {
            return;
        }
        const double share = cosines / square * lamp_area_ / std::numbers::pi *
                             share_of_lamps(glm::dot(to_lamp, normal) / std::sqrt(square),
                                            -glm::dot(to_lamp, lamp.normal) / std::sqrt(square), square);
        const std::vector<double>& exitance =
            scene_.materials[scene_.surfaces[lamp.surface].material].exitance;
        for (std::size_t c = 0; c < channels_; ++c) {
            light[c] += carried[c] * share * exitance[c];
        }
    }

    /// Whether anything lies between two points, each off its surface.
    [[nodiscard]] bool is_hidden(const Vec3& from, const Vec3& to) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        // Directions are not scaled, but lengths along them are.
        RTCRay ray = rays_.ray(from, to - from, static_cast<float>(rays_.scale()));
        rtcOccluded1(rays_.handle(), &context, &ray);
        return ray.tfar < 0.0f;
    }

    /// What a ray meets first, and how far away.
    [[nodiscard]] std::optional<std::pair<std::uint32_t, double>> trace(const Vec3& point, const Vec3& normal,
                                                                        const Vec3& direction) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query{};
        query.ray = rays_.ray(point + clearance_ * normal, direction, std::numeric_limits<float>::infinity());
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(rays_.handle(), &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
            return std::nullopt;
        }
        return std::pair(query.hit.primID, static_cast<double>(query.ray.tfar) / rays_.scale());
    }

    const Scene& scene_;
    std::size_t channels_;
    EmbreeScene rays_;
    double clearance_;
    std::vector<Vec3> normals_; ///< of the surfaces' fronts
    std::vector<std::vector<Side>> sides_of_group_;
    std::vector<Side> lamps_;
    double lamp_area_ = 0.0;
};

/// Means and their standard errors, per channel.
struct Means {
    std::vector<double> irradiance;
    std::vector<double> standard_error;
};

/// @param batches  of paths: the spread of their means tells the error
Means trace_group(const PathTracer& tracer, std::uint32_t group, std::size_t batches, std::size_t paths,
                  std::uint64_t seed) {
    std::vector<std::vector<double>> means(batches, std::vector<double>(tracer.channels(), 0.0));
    parallel_for(batches, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t batch = begin; batch < end; ++batch) {
            std::seed_seq sequence{seed, std::uint64_t{group}, std::uint64_t{batch}};
            Random random(sequence);
            for (std::size_t path = 0; path < paths; ++path) {
                tracer.sample(group, random, means[batch]);
            }
            for (double& mean : means[batch]) {
                mean /= static_cast<double>(paths);
            }
        }
    });
    const auto count = static_cast<double>(batches);
    Means result;
    for (std::size_t c = 0; c < tracer.channels(); ++c) {
        double sum = 0.0;
        double squares = 0.0;
        for (const std::vector<double>& mean : means) {
            sum += mean[c];
            squares += mean[c] * mean[c];
        }
        const double mean = sum / count;
        result.irradiance.push_back(mean);
        result.standard_error.push_back(
            std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1.0)));
    }
    return result;
}

int run(const std::string& file, std::size_t paths, std::uint64_t seed) {
    constexpr std::size_t batches = 256;
    Scene scene = io::read_scene(file);
    if (auto cut = imprint(scene)) {
        scene = std::move(cut->scene); // points under boxes belong to no group
    }
    const PathTracer tracer(scene);
    nlohmann::ordered_json result;
    result["paths_per_group"] = batches * (paths / batches);
    result["seed"] = seed;
    for (std::uint32_t group = 0; group < scene.groups.size(); ++group) {
        const Means means = trace_group(tracer, group, batches, paths / batches, seed);
        result["groups"][scene.groups[group]] = {{"irradiance", means.irradiance},
                                                 {"standard_error", means.standard_error}};
    }
    fmt::print("{}\n", result.dump(1));
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app("Prints the mean irradiance of a scene's groups, by tracing paths, as JSON.");
    std::string file;
    std::size_t paths = std::size_t{1} << 24;
    std::uint64_t seed = 1;
    app.add_option("scene", file, "scene or mesh")->required();
    app.add_option("--paths", paths, "paths for each group")->check(CLI::Range(512, 1 << 30));
    app.add_option("--seed", seed, "other random numbers");
    CLI11_PARSE(app, argc, argv);
    try {
        return run(file, paths, seed);
    } catch (const Error& error) {
        fmt::print(stderr, "path-tracer: {}\n", error.what());
        return 1;
    }
}
