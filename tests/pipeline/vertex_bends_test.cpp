#include "pipeline/vertex_bends.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

using namespace hemi;
using namespace hemi::test;

TEST_CASE("patch size: quadratic fields bend as their interpolation errs", "[pipeline]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(0, 1, 0)}, {1, 1});
    const PatchMesh mesh(scene);
    double squares = 0.0;
    double bends = 0.0;
    // Signs of a and b in turn, as if they varied independently.
    for (const auto& [a, b] : {std::array{3.0, 1.0}, std::array{3.0, -1.0}, std::array{1.0, 3.0},
                               std::array{-1.0, 3.0}, std::array{2.0, 0.0}}) {
        const auto field = [a = a, b = b](double u, double v) {
            return 7.0 + u - 2.0 * v + a * u * u + b * v * v + u * v;
        };
        Solution solution;
        solution.channels = 1;
        std::vector<double> mean(mesh.size(), 0.0);
        std::vector<float> at_corners;
        for (const auto& [u, v] :
             {std::array{0.0, 0.0}, std::array{1.0, 0.0}, std::array{1.0, 1.0}, std::array{0.0, 1.0}}) {
            at_corners.push_back(static_cast<float>(field(u, v)));
        }
        constexpr int cells = 200;
        double square = 0.0;
        for (int k = 0; k < cells * cells; ++k) {
            const double u = (k % cells + 0.5) / cells;
            const double v = (k / cells + 0.5) / cells;
            const double shown = (1 - u) * (1 - v) * field(0, 0) + u * (1 - v) * field(1, 0) +
                                 u * v * field(1, 1) + (1 - u) * v * field(0, 1);
            mean[0] += field(u, v) / (cells * cells);
            square += std::pow(shown - field(u, v), 2.0) / (cells * cells);
        }
        solution.vertex_radiosity = at_corners;
        const std::vector<double> found = vertex_bends(mesh, solution, mean);
        REQUIRE(found.size() == 1);
        CHECK(found[0] == Approx((a + b) / 6.0).epsilon(1e-3));
        squares += square;
        bends += found[0] * found[0];
    }
    CHECK(squares / bends == Approx(square_error_of_bend).epsilon(1e-3));
}
