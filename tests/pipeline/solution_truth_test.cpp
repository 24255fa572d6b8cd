// Printed errors of solutions against exact ones that come from no mesh of hemi's: integral equations, closed
// forms, traced paths.
#include "support/group_irradiance.hpp"
#include "support/scenes.hpp"

#include "hemi/display/vertex_colours.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "hemi/scene/imprint.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

struct Solved {
    PatchMesh mesh;
    Solution solution;
    SolutionError error;
};

Solved solved(const Scene& scene, Preset preset, Gather gather = Gather::off) {
    FactorSettings settings;
    settings.preset = preset;
    settings.engine.device = "cpu";
    PatchMesh mesh(scene);
    const FormFactors factors = compute_form_factors(scene, mesh, settings);
    Solution solution = solve_radiosity(scene, mesh, factors, {}, no_observer(), true);
    gather_at_vertices(scene, mesh, settings, gather, solution);
    solution.patch_size_error = estimate_patch_size_error(scene, mesh, factors, solution, settings);
    const SolutionError error = solution_error(solution).value();
    return {std::move(mesh), std::move(solution), error};
}

/// Nodes and weights of Gauss and Legendre on [0, 1].
std::vector<std::array<double, 2>> gauss_legendre(int count) {
    std::vector<std::array<double, 2>> rule;
    for (int k = 0; k < count; ++k) {
        double x = std::cos(M_PI * (k + 0.75) / (count + 0.5));
        double slope = 0.0;
        for (int step = 0; step < 50; ++step) { // Newton
            double before = 1.0;
            double value = x;
            for (int n = 2; n <= count; ++n) {
                before = std::exchange(value, ((2 * n - 1) * x * value - (n - 1) * before) / n);
            }
            slope = count * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        rule.push_back({0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)});
    }
    return rule;
}

/// Radiosity of two unit squares face to face, a distance apart, that both radiate 1: the integral equation
/// b = 1 + rho K b by Nystrom's method. The kernel is analytic, so that the rule is exact to rounding.
class Plates {
public:
    Plates(double reflectance, double distance)
        : reflectance_(reflectance), distance_(distance), rule_(gauss_legendre(24)) {
        for (const auto& [x, wx] : rule_) {
            for (const auto& [y, wy] : rule_) {
                nodes_.push_back({x, y, wx * wy, 1.0});
            }
        }
        change_ = 1.0;
        while (change_ > 1e-12) {
            std::vector<Node> next = nodes_;
            change_ = 0.0;
            for (std::size_t k = 0; k < next.size(); ++k) {
                next[k].value = at(next[k].x, next[k].y);
                change_ = std::max(change_, std::abs(next[k].value - nodes_[k].value));
            }
            nodes_ = std::move(next);
        }
    }

    [[nodiscard]] double at(double x, double y) const {
        double light = 0.0;
        for (const Node& node : nodes_) {
            const double square =
                (x - node.x) * (x - node.x) + (y - node.y) * (y - node.y) + distance_ * distance_;
            light += node.weight * node.value / (square * square);
        }
        return 1.0 + reflectance_ * distance_ * distance_ / M_PI * light;
    }
    [[nodiscard]] double mean_irradiance() const {
        double sum = 0.0;
        for (const Node& node : nodes_) {
            sum += node.weight * (node.value - 1.0) / reflectance_;
        }
        return sum;
    }

private:
    struct Node {
        double x, y, weight, value;
    };
    double reflectance_;
    double distance_;
    std::vector<std::array<double, 2>> rule_;
    std::vector<Node> nodes_;
    double change_ = 0.0;
};

Scene plates(double reflectance, double distance, std::uint32_t cells) {
    Scene scene = empty_scene();
    scene.materials[0] = {"plate", {reflectance}, {1.0}};
    const double d = distance;
    add_polygon(scene, "lower", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {cells, cells});
    add_polygon(scene, "upper", {{0, 0, d}, {0, 1, d}, {1, 1, d}, {1, 0, d}}, {cells, cells});
    return scene;
}

/// True errors of the plates' field, over the rms of the reflected radiosity: of constants, and of the
/// interpolated corner values.
struct TrueErrors {
    double field, vertices;
};
TrueErrors true_errors(const Solved& solved, const Plates& exact) {
    const PatchMesh& mesh = solved.mesh;
    const std::vector<float> corners =
        solved.solution.vertex_radiosity.empty()
            ? corner_values(mesh, 1, solved.solution.radiosity, solved.solution.back_face_share)
            : solved.solution.vertex_radiosity;
    const auto rule = gauss_legendre(4);
    double field = 0.0;
    double vertices = 0.0;
    double reflected = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners at = mesh.corners(i);
        const auto corner = [&](std::uint32_t k) {
            return static_cast<double>(corners[std::size_t{i} * 4 + k]);
        };
        for (const auto& [a, wa] : rule) {
            for (const auto& [b, wb] : rule) {
                const Vec3 point =
                    at.points[0] + a * (at.points[1] - at.points[0]) + b * (at.points[3] - at.points[0]);
                const double right = exact.at(point.x, point.y);
                const double shown = (1 - a) * (1 - b) * corner(0) + a * (1 - b) * corner(1) +
                                     a * b * corner(2) + (1 - a) * b * corner(3);
                field += wa * wb * std::pow(solved.solution.radiosity[i] - right, 2.0);
                vertices += wa * wb * std::pow(shown - right, 2.0);
                reflected += wa * wb * std::pow(right - 1.0, 2.0);
            }
        }
    }
    return {std::sqrt(field / reflected), std::sqrt(vertices / reflected)};
}

void check_printed(double printed, double truth) {
    INFO("printed " << printed << ", true " << truth);
    CHECK(truth < 2.0 * printed);
    CHECK(printed < 4.0 * truth);
}

/// A sphere of radius 1 seen from within, in n rings of 2 n facets: the first sixth of them are the source.
Scene cavity(std::uint32_t n, double reflectance) {
    Scene scene = empty_scene();
    scene.materials[0] = {"wall", {reflectance}, {0.0}};
    scene.materials.push_back({"source", {reflectance}, {1.0}});
    const auto at = [n](std::uint32_t ring, std::uint32_t sector) {
        const double theta = M_PI * ring / n;
        const double phi = M_PI * sector / n;
        return Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    };
    for (std::uint32_t ring = 0; ring < n; ++ring) {
        for (std::uint32_t sector = 0; sector < 2 * n; ++sector) {
            std::vector<Vec3> facet{at(ring, sector)};
            if (ring > 0) {
                facet.push_back(at(ring, sector + 1));
            }
            facet.push_back(at(ring + 1, sector + 1));
            if (ring + 1 < n) {
                facet.push_back(at(ring + 1, sector));
            }
            const bool source = 6 * ring < n;
            add_polygon(scene, source ? "source" : "wall", std::move(facet));
            scene.surfaces.back().material = source ? 1 : 0;
        }
    }
    return scene;
}

} // namespace

TEST_CASE("solution error: two plates against their integral equation", "[pipeline]") {
    for (const double distance : {1.0, 0.4}) {
        const Plates exact(0.8, distance);
        for (const std::uint32_t cells : {4u, 8u}) {
            for (const Preset preset : {Preset::fast, Preset::standard}) {
                for (const Gather gather : {Gather::off, Gather::on}) {
                    const Solved found = solved(plates(0.8, distance, cells), preset, gather);
                    const TrueErrors truth = true_errors(found, exact);
                    INFO("distance " << distance << ", " << cells << " cells, preset " << to_word(preset)
                                     << (gather == Gather::on ? ", gathered" : ""));
                    check_printed(found.error.field.rms, truth.field);
                    check_printed(found.error.vertices.rms, truth.vertices);
                    for (std::size_t g = 0; g < 2; ++g) {
                        const double off = std::abs(
                            group_irradiance(found.mesh, found.solution)[g] / exact.mean_irradiance() - 1.0);
                        INFO("group " << g << ": printed " << found.error.groups[g] << ", true " << off);
                        CHECK(off < 2.0 * found.error.groups[g]);
                    }
                }
            }
        }
    }
}

TEST_CASE("solution error: a spherical cavity is lit evenly, whatever part of it shines", "[pipeline]") {
    // F = A / S between any parts of a sphere, so that G = f E / (1 - rho), where the share f of it radiates
    // E. Facets err by about 1 / n²; that is not hemi's, and is extrapolated.
    const double reflectance = 0.6;
    std::array<std::vector<double>, 2> relative;
    std::array<double, 2> printed{};
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        const Solved found = solved(cavity(k == 0 ? 10 : 20, reflectance), Preset::fast);
        double source = 0.0;
        double area = 0.0;
        for (std::uint32_t i = 0; i < found.mesh.size(); ++i) {
            source += found.solution.exitance[i] * found.mesh.areas()[i];
            area += found.mesh.areas()[i];
        }
        const double exact = source / area / (1.0 - reflectance);
        for (const double light : group_irradiance(found.mesh, found.solution)) {
            relative[k].push_back(light / exact - 1.0);
        }
        printed[k] = found.error.field.rms;
    }
    for (std::size_t g = 0; g < relative[0].size(); ++g) {
        INFO("group " << g << ": " << relative[0][g] << ", " << relative[1][g]);
        CHECK(std::abs((4.0 * relative[1][g] - relative[0][g]) / 3.0) < 1e-3);
    }
    INFO("field, printed: " << printed[0] << ", " << printed[1]);
    CHECK(printed[0] > 1.7 * printed[1]);
}

TEST_CASE("solution error: means of groups against traced paths", "[pipeline][slow]") {
    // The scenes are those of tools/error-truth, the means those of tests/data/path-traced/README.md.
    std::uint32_t pairs = 0;
    std::uint32_t too_small = 0;
    std::uint32_t solutions = 0;
    std::uint32_t too_large = 0;
    std::string table;
    for (const std::string name : {"boxes", "cove"}) {
        const Scene scene = io::read_scene(data_path("path-traced/" + name + ".json"));
        std::ifstream file(data_path("path-traced/" + name + "-irradiance.json"));
        const nlohmann::json truth = nlohmann::json::parse(file);
        for (const std::uint32_t times : {1u, 2u}) {
            Scene finer = scene;
            for (Surface& surface : finer.surfaces) {
                surface.patches = Grid{surface.patches->u * times, surface.patches->v * times};
            }
            const Scene cut = imprint(finer).value().scene;
            for (const Preset preset : {Preset::fast, Preset::standard}) {
                const Solved found = solved(cut, preset);
                const std::vector<double> means = group_irradiance(found.mesh, found.solution);
                double worst_printed = 0.0;
                double worst = 0.0;
                for (std::size_t g = 0; g < means.size(); ++g) {
                    const nlohmann::json& group = truth.at("groups").at(cut.groups[g]);
                    const double right = group["irradiance"][0];
                    const double unsure = 2.0 * group["standard_error"][0].get<double>() / right;
                    CHECK(unsure < 1.4e-3);
                    const double off = std::abs(means[g] / right - 1.0);
                    const double printed = found.error.groups[g];
                    CHECK(std::isfinite(off));
                    CHECK(std::isfinite(printed));
                    ++pairs;
                    too_small += off > 2.0 * printed + unsure ? 1 : 0;
                    worst_printed = std::max(worst_printed, printed);
                    worst = std::max(worst, off);
                    table += fmt::format("{} x {}, {}, {}: printed {:.4f}, true {:.4f}\n", name, times,
                                         to_word(preset), cut.groups[g], printed, off);
                }
                INFO(table);
                CHECK(worst < 2.0 * worst_printed);
                ++solutions;
                too_large += worst_printed > 4.0 * worst ? 1 : 0;
            }
        }
    }
    INFO(table);
    CHECK(pairs == 72);
    CHECK(too_small <= pairs / 10);
    CHECK(too_large <= solutions / 4);
}
