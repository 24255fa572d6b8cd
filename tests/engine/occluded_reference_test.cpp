#include "support/occluded_reference.hpp"
#include "support/scenes.hpp"

#include "hemi/engine/exchange_area.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

using namespace hemi;
using namespace hemi::test;

namespace {

std::vector<Vec3> square(const Vec3& corner, const Vec3& u, const Vec3& v) {
    return {corner, corner + u, corner + u + v, corner + v};
}

/// Visible share of F(i, j) by rays between random points, to a few thousandths of the factor.
double ray_factor(const PatchMesh& mesh, std::uint32_t i, std::uint32_t j, int rays) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto point_on = [&](const PatchCorners& patch) {
        const auto& p = patch.points; // parallelograms
        return p[0] + uniform(random) * (p[1] - p[0]) + uniform(random) * (p[3] - p[0]);
    };
    double sum = 0.0;
    for (int ray = 0; ray < rays; ++ray) {
        const Vec3 x = point_on(mesh.corners(i));
        const Vec3 y = point_on(mesh.corners(j));
        const Vec3 d = y - x;
        const double cosines = glm::dot(d, mesh.normal(i)) * -glm::dot(d, mesh.normal(j));
        if (glm::dot(d, mesh.normal(i)) <= 0.0 || glm::dot(d, mesh.normal(j)) >= 0.0) {
            continue;
        }
        const bool hidden =
            std::any_of(mesh.surfaces().begin(), mesh.surfaces().end(), [&](const Surface& surface) {
                const auto s = surface.polygon();
                const Vec3 normal = area_vector(s);
                const double along = glm::dot(normal, d);
                const double t = glm::dot(normal, s[0] - x) / along;
                if (!(t > 1e-9 && t < 1.0 - 1e-9)) {
                    return false;
                }
                for (std::size_t k = 0; k < s.size(); ++k) {
                    const Vec3& a = s[k];
                    if (glm::dot(glm::cross(s[(k + 1) % s.size()] - a, x + t * d - a), normal) < 0.0) {
                        return false;
                    }
                }
                return true;
            });
        sum += hidden ? 0.0 : cosines / std::pow(glm::dot(d, d), 2);
    }
    return sum / rays / std::numbers::pi * mesh.areas()[j];
}

struct RowCheck {
    double sum_error = 0.0;
    double reciprocity = 0.0; ///< largest |A_i F(i, j) - A_j F(j, i)| / max(A_i, A_j)
    double convergence = 0.0; ///< rms change from fewer points to more
};

RowCheck check_rows(const PatchMesh& mesh, std::uint32_t count, std::size_t fewer, std::size_t more) {
    const OccludedReference coarse(mesh, {"first", "second"}, fewer);
    const OccludedReference fine(mesh, {"first", "second"}, more);
    const auto patches = sampled_patches(mesh, count);
    std::vector<std::vector<double>> rows;
    RowCheck check;
    double squares = 0.0;
    std::size_t pairs = 0;
    for (const std::uint32_t i : patches) {
        rows.push_back(fine.row(i));
        const auto other = coarse.row(i);
        const auto& row = rows.back();
        check.sum_error =
            std::max(check.sum_error, std::abs(std::accumulate(row.begin(), row.end(), 0.0) - 1.0));
        for (std::size_t j = 0; j < row.size(); ++j) {
            squares += std::pow(row[j] - other[j], 2);
            pairs += row[j] > 0.0 ? 1 : 0;
        }
    }
    check.convergence = std::sqrt(squares / static_cast<double>(pairs));
    for (std::size_t a = 0; a < patches.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            const double area_a = mesh.areas()[patches[a]];
            const double area_b = mesh.areas()[patches[b]];
            check.reciprocity = std::max(
                check.reciprocity, std::abs(area_a * rows[a][patches[b]] - area_b * rows[b][patches[a]]) /
                                       std::max(area_a, area_b));
        }
    }
    return check;
}

} // namespace

TEST_CASE("exchange_area: closed forms of squares that face, touch and are far apart", "[engine]") {
    const Vec3 x(1, 0, 0);
    const Vec3 y(0, 1, 0);
    const Vec3 z(0, 0, 1);
    const auto floor = square(Vec3(0.0), x, y);
    CHECK(exchange_area(floor, square(z, y, x)) == Approx(0.19982489569838738).margin(1e-12).epsilon(0));
    CHECK(exchange_area(floor, square(Vec3(0.0), y, z)) ==
          Approx(0.20004377607540316).margin(1e-12).epsilon(0));
    CHECK(exchange_area(square(Vec3(0.0), y, z), floor) ==
          Approx(0.20004377607540316).margin(1e-12).epsilon(0));
    // Howell C-11, squares of side 1 at distance 0.1.
    const double w = 10.0;
    const double gap =
        2.0 / (std::numbers::pi * w * w) *
        (std::log((1.0 + w * w) / std::sqrt(1.0 + 2.0 * w * w)) +
         2.0 * w * std::sqrt(1.0 + w * w) * std::atan(w / std::sqrt(1.0 + w * w)) - 2.0 * w * std::atan(w));
    CHECK(exchange_area(floor, square(0.1 * z, y, x)) == Approx(gap).margin(1e-10).epsilon(0));
    // Far apart: the kernel at the centres, to the square of size over distance.
    CHECK(exchange_area(floor, square(1000.0 * z, y, x)) * std::numbers::pi * 1e6 ==
          Approx(1.0).epsilon(1e-6));
    // Behind, beside in one plane, and turned away: nothing.
    CHECK(exchange_area(floor, square(-z, x, y)) == 0.0);
    CHECK(exchange_area(floor, square(x, x, y)) == 0.0);
    CHECK(exchange_area(floor, square(z, x, y)) == 0.0);
}

TEST_CASE("exchange_area: additive where one polygon crosses the other's plane", "[engine]") {
    const Vec3 x(1, 0, 0);
    const Vec3 y(0, 1, 0);
    const auto floor = square(Vec3(0.0), x, y);
    const Vec3 slope(0.0, 0.3, 1.0);
    const auto crossing = square(Vec3(1.2, 0, 0) - slope, 2.0 * slope, y); // half of it below the floor
    const auto upper = square(Vec3(1.2, 0, 0), slope, y);
    const double whole = exchange_area(floor, crossing);
    CHECK(whole > 0.0);
    CHECK(whole == Approx(exchange_area(floor, upper)).epsilon(1e-10));
    CHECK(whole == Approx(exchange_area(crossing, floor)).epsilon(1e-10));
}

TEST_CASE("gauss_points: exact for polynomials on a trapezium and a triangle", "[engine]") {
    const std::vector<Vec3> trapezium{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(3, 2, 0), Vec3(1, 2, 0)};
    const std::vector<Vec3> triangle{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 3, 0)};
    for (const auto& polygon : {trapezium, triangle}) {
        Vec3 mean(0.0);
        for (const QuadraturePoint& point : gauss_points(polygon, 4)) {
            mean += point.weight * point.position;
        }
        CHECK(glm::length(mean - area_centroid(polygon)) < 1e-14);
    }
}

TEST_CASE("OccludedReference: without anything hidden it is the exchange area", "[engine]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 4);
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {}, 2);
    for (const std::uint32_t i : sampled_patches(mesh, 12)) {
        const auto row = reference.row(i);
        CHECK(std::accumulate(row.begin(), row.end(), 0.0) == Approx(1.0).margin(1e-11).epsilon(0));
    }
}

TEST_CASE("OccludedReference: rows of the room with turned boxes sum to one and are reciprocal",
          "[engine][slow]") {
    const PatchMesh mesh(coarse_room_with_turned_boxes());
    CHECK(mesh.size() == 1110);
    const RowCheck check = check_rows(mesh, 32, 16, 24);
    INFO("row sums off by " << check.sum_error << ", reciprocity by " << check.reciprocity << ", convergence "
                            << check.convergence);
    CHECK(check.sum_error < 5e-6);
    CHECK(check.reciprocity < 3e-7);
    CHECK(check.convergence < 3e-7);
}

TEST_CASE("OccludedReference: rows of the fine room with turned boxes", "[engine][slow]") {
    const PatchMesh mesh(fine_room_with_turned_boxes());
    CHECK(mesh.size() == 5790);
    const RowCheck check = check_rows(mesh, 24, 12, 16);
    INFO("row sums off by " << check.sum_error << ", reciprocity by " << check.reciprocity << ", convergence "
                            << check.convergence);
    CHECK(check.sum_error < 1e-6);
    CHECK(check.reciprocity < 1e-7);
    CHECK(check.convergence < 1e-7);
}

TEST_CASE("OccludedReference: partly hidden pairs agree with rays", "[engine][slow]") {
    const PatchMesh mesh(room_with_turned_boxes(5, 2, 2));
    const OccludedReference reference(mesh, {"first", "second"}, 20);
    std::size_t partly = 0;
    for (const std::uint32_t i : sampled_patches(mesh, 12)) {
        const auto row = reference.row(i);
        for (std::uint32_t j = i % 7; j < mesh.size(); j += 7) {
            const double whole =
                exchange_area(mesh.corners(i).polygon(), mesh.corners(j).polygon()) / mesh.areas()[i];
            const bool partly_hidden = row[j] > 0.05 * whole && row[j] < 0.95 * whole;
            partly += partly_hidden ? 1 : 0;
            if (partly_hidden || row[j] == 0.0) {
                INFO("patches " << i << " and " << j << ", unoccluded " << whole);
                CHECK(row[j] ==
                      Approx(ray_factor(mesh, i, j, 20000)).margin(0.02 * whole + 1e-12).epsilon(0));
            }
        }
    }
    CHECK(partly > 20);
}

TEST_CASE("OccludedReference: of a patch half under a block the other half sees the room", "[engine][slow]") {
    for (const double covered : {0.1, 0.5, 0.9}) {
        INFO("covered " << covered);
        const StraddledRoom room = straddled_room(covered);
        const PatchMesh whole(room.whole);
        const PatchMesh cut(room.cut);
        const auto parent = parents(whole, cut);
        const OccludedReference reference(cut, {"block"}, 24);
        const OccludedReference finer(cut, {"block"}, 32);
        for (std::uint32_t i = 0; i < whole.size(); ++i) {
            const Vec3& centre = whole.centres()[i];
            const bool beside = centre.y < 0.25 || centre.y > 0.75 || centre.x < 0.25 || centre.x > 0.75;
            if (whole.groups()[whole.group(i)] != "z0" || (!beside && centre.x > 0.5)) {
                continue;
            }
            INFO("patch at " << centre.x << ", " << centre.y);
            const auto row = straddled_row(whole, cut, parent, reference, i);
            const auto other = straddled_row(whole, cut, parent, finer, i);
            double change = 0.0;
            for (std::size_t j = 0; j < row.size(); ++j) {
                change = std::max(change, std::abs(row[j] - other[j]));
            }
            CHECK(std::accumulate(row.begin(), row.end(), 0.0) ==
                  Approx(beside ? 1.0 : 1.0 - covered).margin(1e-4).epsilon(0));
            CHECK(change < 2e-5);
        }
    }
}

TEST_CASE("OccludedReference: rows close under a sheet sum to one", "[engine][slow]") {
    for (const double gap : {0.05, 0.2, 0.5}) {
        const PatchMesh mesh(room_with_sheet(gap));
        const OccludedReference reference(mesh, {"sheet"}, 32);
        for (const std::uint32_t i : sampled_patches(mesh, 30)) {
            INFO("gap " << gap << ", patch " << i << " of " << mesh.groups()[mesh.group(i)]);
            const auto row = reference.row(i);
            CHECK(std::accumulate(row.begin(), row.end(), 0.0) == Approx(1.0).margin(5e-5).epsilon(0));
        }
    }
}

TEST_CASE("ExchangeAreas: agree with integrals of another kind", "[engine]") {
    for (const Scene& scene : {coarse_room_with_turned_boxes(), tapered_box(5), room_with_sheet(0.05),
                               read_case("14_sphere_interior.obj"), read_case("17_needle_triangle.obj")}) {
        const PatchMesh mesh(scene);
        const ExchangeAreas exact(mesh, ExchangeRule::exact);
        const ExchangeAreas standard(mesh, ExchangeRule::standard);
        double exact_error = 0.0;
        double standard_error = 0.0;
        for (const std::uint32_t i : sampled_patches(mesh, 12)) {
            for (std::uint32_t j = 0; j < mesh.size(); ++j) {
                const double area = std::min(mesh.areas()[i], mesh.areas()[j]);
                const double expected = exchange_area(mesh.corners(i).polygon(), mesh.corners(j).polygon());
                exact_error = std::max(exact_error, std::abs(exact(i, j) - expected) / area);
                standard_error = std::max(standard_error, std::abs(standard(i, j) - expected) / area);
            }
        }
        CHECK(exact_error < 1e-9);
        CHECK(standard_error < 3e-6);
    }
}
