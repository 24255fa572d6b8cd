#include "matrix/exchange_product.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

constexpr std::uint32_t size = 150; // three blocks
const std::vector<std::uint32_t> unknown{0, 7, 64, 149};

bool is_unknown(std::uint32_t i) {
    return std::find(unknown.begin(), unknown.end(), i) != unknown.end();
}

std::vector<double> random_values(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> values(count);
    for (double& value : values) {
        value = random() - 0.5;
    }
    return values;
}

/// Checks y = (X + diagonal) z, as written out, in the known rows.
void check_rows(const ReciprocalScene& scene, const FormFactorMatrix& factors,
                const std::vector<double>& diagonal, const std::vector<double>& z, std::size_t stride,
                bool with_unknown) {
    std::vector<double> y(size * stride, -1.0);
    ExchangeProduct(factors, scene.areas, stride).apply(diagonal, z, y, with_unknown);
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::size_t c = 0; c < stride && factors.known(i); ++c) {
            double expected = scene.areas[i] * diagonal[i] * z[i * stride + c];
            for (std::uint32_t j = 0; j < size; ++j) {
                expected += scene.areas[i] * scene.rows[i][j] * z[j * stride + c];
            }
            // Factors are stored as 32-bit numbers.
            REQUIRE(y[i * stride + c] == Approx(expected).margin(1e-7).epsilon(0));
        }
    }
}

} // namespace

TEST_CASE("ExchangeProduct: the sum over the pairs, as written out", "[matrix]") {
    const ReciprocalScene scene = reciprocal_scene(size, 5);
    const FormFactorMatrix all = dense_matrix(scene.rows);
    const FormFactorMatrix some = forget_rows(all, unknown);
    const std::vector<double> diagonal = random_values(size, 6);
    for (const std::size_t stride : {std::size_t{1}, std::size_t{2}, std::size_t{4}, std::size_t{8}}) {
        CAPTURE(stride);
        const std::vector<double> z = random_values(size * stride, 7);
        check_rows(scene, all, diagonal, z, stride, false);
        check_rows(scene, some, diagonal, z, stride, true);
        std::vector<double> zero_in_unknown = z;
        for (std::uint32_t i = 0; i < size; ++i) {
            for (std::size_t c = 0; c < stride && is_unknown(i); ++c) {
                zero_in_unknown[i * stride + c] = 0.0;
            }
        }
        check_rows(scene, some, diagonal, zero_in_unknown, stride, false);
    }
}

TEST_CASE("ExchangeProduct: of rows with clusters the mean of their matrix and its transpose", "[matrix]") {
    constexpr std::uint32_t count = 200;
    const ReciprocalScene scene = reciprocal_scene(count, 5);
    Random random(8);
    std::vector<double> weights(count);
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        weights[i] = i % 5 == 0 ? 0.0 : random();
        order[i] = i * 77 % count; // every patch once
    }
    std::vector<SourceClusters::Node> nodes{{0, count, 0}};
    for (std::uint32_t k = 0; k < nodes.size(); ++k) {
        const auto [begin, end, child] = nodes[k];
        if (end - begin > 1) {
            const std::uint32_t middle = begin + std::max(1u, (end - begin) / 3);
            nodes[k].child = static_cast<std::uint32_t>(nodes.size());
            nodes.push_back({begin, middle, 0});
            nodes.push_back({middle, end, 0});
        }
    }
    const auto clusters = std::make_shared<SourceClusters>(order, nodes, weights);
    FormFactorMatrix factors(count, clusters);
    std::vector<RowBlock> blocks = factors.take_blocks();
    for (RowBlock& block : blocks) {
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            for (std::uint32_t column = 0; column < factors.columns(); ++column) {
                if (random() < 0.05 && column != block.first_row + local) {
                    block.columns.push_back(column);
                    block.values.push_back(static_cast<float>(random()));
                }
            }
            block.begin[local + 1] = block.columns.size();
            block.known[local] = 1;
        }
        factors.set_block(std::move(block));
    }
    DenseRows exchange(count, std::vector<double>(count, 0.0));
    for (std::uint32_t i = 0; i < count; ++i) {
        visit_sources(factors, factors.row(i), [&](std::uint32_t j, double factor) {
            exchange[i][j] += 0.5 * scene.areas[i] * factor;
            exchange[j][i] += 0.5 * scene.areas[i] * factor;
        });
    }
    const std::vector<double> diagonal = random_values(count, 6);
    for (const std::size_t stride : {std::size_t{1}, std::size_t{2}, std::size_t{8}}) {
        CAPTURE(stride);
        const std::vector<double> z = random_values(count * stride, 7);
        std::vector<double> y(count * stride, -1.0);
        ExchangeProduct product(factors, scene.areas, stride);
        product.apply(diagonal, z, y, false);
        product.apply(diagonal, z, y, true); // nothing stays of the first
        for (std::uint32_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < stride; ++c) {
                double expected = scene.areas[i] * diagonal[i] * z[i * stride + c];
                for (std::uint32_t j = 0; j < count; ++j) {
                    expected += exchange[i][j] * z[j * stride + c];
                }
                REQUIRE(y[i * stride + c] == Approx(expected).margin(1e-11).epsilon(0));
            }
        }
    }
    CHECK_THROWS_WITH(ExchangeProduct(FormFactorMatrix(count, clusters), scene.areas, 1),
                      Catch::Matchers::Contains("all rows must be known"));
}

TEST_CASE("ExchangeProduct: spans of other sizes are refused", "[matrix]") {
    const ReciprocalScene scene = reciprocal_scene(size, 5);
    const FormFactorMatrix factors = dense_matrix(scene.rows);
    ExchangeProduct product(factors, scene.areas, 2);
    const std::vector<double> diagonal(size, 0.0);
    const std::vector<double> z(size * 2, 1.0);
    std::vector<double> y(size * 2);
    CHECK_NOTHROW(product.apply(diagonal, z, y, false));
    CHECK_THROWS_AS(product.apply(std::span(diagonal).first(size - 1), z, y, false), InvalidArgument);
    CHECK_THROWS_AS(product.apply(diagonal, std::span(z).first(size), y, false), InvalidArgument);
    CHECK_THROWS_AS(product.apply(diagonal, z, std::span(y).first(size), false), InvalidArgument);
}
