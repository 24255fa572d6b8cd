#include "hemi/matrix/product.hpp"

#include "hemi/core/error.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace hemi;
using namespace hemi::test;

TEST_CASE("multiply: every channel is the sum over the row, as written out", "[matrix]") {
    Random random(4);
    constexpr std::uint32_t size = 150; // three blocks
    constexpr std::uint32_t channels = 3;
    DenseRows rows(size, std::vector<double>(size));
    for (auto& row : rows) {
        for (double& value : row) {
            value = random() < 0.3 ? static_cast<double>(static_cast<float>(random() / size)) : 0.0;
        }
    }
    std::vector<double> values(size * channels);
    for (double& value : values) {
        value = random();
    }
    std::vector<double> product(size * channels, -1.0);
    multiply(dense_matrix(rows), values, channels, product);
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
            double sum = 0.0;
            for (std::uint32_t j = 0; j < size; ++j) {
                sum += rows[i][j] * values[j * channels + c];
            }
            CHECK(product[i * channels + c] == sum);
        }
    }
}

TEST_CASE("multiply: unknown rows give zero", "[matrix]") {
    const FormFactorMatrix unknown(2);
    std::vector<double> product(2, -1.0);
    multiply(unknown, std::vector<double>{1.0, 1.0}, 1, product);
    CHECK(product == std::vector<double>{0.0, 0.0});
}

TEST_CASE("multiply: sizes that do not match are refused", "[matrix]") {
    const FormFactorMatrix matrix(2);
    std::vector<double> product(2);
    CHECK_THROWS_AS(multiply(matrix, std::vector<double>(3), 1, product), InvalidArgument);
    CHECK_THROWS_AS(multiply(matrix, std::vector<double>(4), 2, product), InvalidArgument);
}
