#include "engine/gathering.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "support/device.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Two channels: patches that send more and more, and a few that send at all.
std::vector<double> some_light(std::uint32_t patches) {
    std::vector<double> light;
    for (std::uint32_t i = 0; i < patches; ++i) {
        light.push_back(1.0 + i % 7);
        light.push_back(i % 11 == 0 ? 30.0 : 0.0);
    }
    return light;
}

const std::vector<double> sky{0.5, 2.0};

/// sum_j F(i, j) B_j + e_i B_env, as it is written.
std::vector<double> by_the_book(const RowView& row, const std::vector<double>& light) {
    std::vector<double> result{row.environment * sky[0], row.environment * sky[1]};
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        for (std::size_t c = 0; c < 2; ++c) {
            result[c] += static_cast<double>(row.values[k]) * light[row.columns[k] * std::size_t{2} + c];
        }
    }
    return result;
}

} // namespace

TEST_CASE("Gathering: a row of form factors gives what its factors bring", "[engine][gl][every-device]") {
    const PatchMesh mesh(open_corner());
    const std::vector<double> light = some_light(mesh.size());
    const Gathering gathering(mesh, 2, light, sky);
    const auto engine =
        make_hemicube_engine(mesh, {.resolution = 32}, {test_device(), 1, find_worker_program()});
    const FormFactorMatrix factors = compute_matrix(*engine);
    std::vector<double> gathered(2);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        gathering.gather(i, factors.row(i), gathered);
        const std::vector<double> expected = by_the_book(factors.row(i), light);
        REQUIRE(expected[0] > 0.0);
        CHECK(gathered[0] == Approx(expected[0]).epsilon(1e-12));
        CHECK(gathered[1] == Approx(expected[1]).epsilon(1e-12));
    }
}

TEST_CASE("Gathering: a row of visibility gives about what the hybrid's factors bring",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(room_with_blocks(8));
    const std::vector<double> light = some_light(mesh.size());
    const Gathering gathering(mesh, 2, light, sky);
    const HemicubeSettings settings{.resolution = 64, .eye_points = 4};
    const auto engine = make_visibility_engine(mesh, settings, {test_device(), 2, find_worker_program()});
    std::vector<std::uint32_t> patches(mesh.size());
    std::iota(patches.begin(), patches.end(), 0U);
    const FormFactorMatrix factors =
        compute_visibility_weighted(*engine, mesh, patches, {}, Enclosure::closed);
    double squares = 0.0;
    double largest = 0.0;
    std::size_t count = 0;
    std::vector<double> gathered(2);
    engine->rows(patches, [&](std::uint32_t i, const VisibilityRow& row) {
        if (row.blocked > 0.01) {
            return;
        }
        gathering.gather(i, row, gathered);
        const std::vector<double> expected = by_the_book(factors.row(i), light);
        for (std::size_t c = 0; c < 2; ++c) {
            const double error = gathered[c] / expected[c] - 1.0;
            squares += error * error;
            largest = std::max(largest, std::abs(error));
            ++count;
        }
    });
    REQUIRE(count > mesh.size());
    INFO("rms " << std::sqrt(squares / static_cast<double>(count)) << ", largest " << largest);
    CHECK(std::sqrt(squares / static_cast<double>(count)) < 0.01);
    CHECK(largest < 0.1);
}

TEST_CASE("Gathering: sizes that do not match are refused", "[engine]") {
    const PatchMesh mesh(open_corner());
    const std::vector<double> light = some_light(mesh.size());
    CHECK_THROWS_AS(Gathering(mesh, 3, light, {}), InvalidArgument);
    CHECK_THROWS_AS(Gathering(mesh, 0, {}, {}), InvalidArgument);
    CHECK_THROWS_AS(Gathering(mesh, 2, light, std::vector<double>(1)), InvalidArgument);
}
