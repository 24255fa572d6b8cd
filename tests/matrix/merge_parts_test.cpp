#include "hemi/core/error.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using test::dense_matrix;

namespace {

/// Two patches, of which the first is in two parts; a third one of which nothing is left.
FormFactors in_parts() {
    FormFactors factors;
    factors.matrix = dense_matrix({{0.0, 0.1, 0.3}, {0.2, 0.0, 0.5}, {0.15, 0.125, 0.0}}, {0.6, 0.2, 0.7},
                                  {0.0, 0.1, 0.025});
    factors.areas = {1.0, 0.5, 2.0};
    factors.groups = {"one", "two"};
    factors.group_of = {0, 0, 1};
    factors.parts.patch_of = {0, 0, 2};
    factors.parts.group_of = {0, 0, 1};
    return factors;
}

} // namespace

TEST_CASE("PatchParts: areas add up, values are means by area", "[matrix]") {
    const PatchParts parts{{1, 0, 1, 1}, {0, 0, 0}};
    const std::vector<double> areas{1.0, 2.0, 3.0, 4.0};
    CHECK(areas_of_patches(parts, areas) == std::vector<double>{2.0, 8.0, 0.0});
    const std::vector<double> means =
        means_of_patches(parts, areas, std::vector<double>{1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 4.0, 40.0}, 2);
    const std::vector<double> expected{2.0, 20.0, (1.0 + 9.0 + 16.0) / 8.0, (10.0 + 90.0 + 160.0) / 8.0,
                                       0.0, 0.0};
    REQUIRE(means.size() == expected.size());
    for (std::size_t k = 0; k < means.size(); ++k) {
        CHECK(means[k] == Approx(expected[k]));
    }
    CHECK_THROWS_AS(areas_of_patches(parts, std::vector<double>{1.0}), InvalidArgument);
    CHECK_THROWS_AS(areas_of_patches({{3}, {0, 0}}, std::vector<double>{1.0}), InvalidArgument);
    CHECK_THROWS_AS(means_of_patches(parts, areas, areas, 2), InvalidArgument);
}

TEST_CASE("Merged parts: sums where light arrives, means by area where it leaves", "[matrix]") {
    const FormFactors merged = merge_parts(in_parts());
    REQUIRE(merged.matrix.size() == 3);
    REQUIRE(merged.matrix.all_known());
    CHECK_FALSE(merged.parts.any());
    CHECK(merged.areas == std::vector<double>{1.5, 0.0, 2.0});
    CHECK(merged.group_of == std::vector<std::uint32_t>{0, 0, 1});
    const RowView row = merged.matrix.row(0);
    REQUIRE(row.columns.size() == 2);
    CHECK(row.columns[0] == 0);
    CHECK(row.columns[1] == 2);
    CHECK(row.values[0] == Approx((1.0 * 0.1 + 0.5 * 0.2) / 1.5));
    CHECK(row.values[1] == Approx((1.0 * 0.3 + 0.5 * 0.5) / 1.5));
    CHECK(row.environment == Approx((1.0 * 0.6 + 0.5 * 0.2) / 1.5));
    CHECK(row.blocked == Approx(0.5 * 0.1 / 1.5));
    const RowView gone = merged.matrix.row(1);
    CHECK(gone.columns.empty());
    CHECK(gone.blocked == 1.0);
    // What is reciprocal and balanced stays so, and groups see what they saw.
    CHECK(is_reciprocal(reciprocity(merged.matrix, merged.areas)));
    CHECK(row_sums(merged.matrix).balance_error_max < 1e-7);
    const FormFactors before = in_parts();
    const GroupFactors by_part = group_factors(before.matrix, before.areas, before.group_of, 2);
    const GroupFactors by_patch = group_factors(merged.matrix, merged.areas, merged.group_of, 2);
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(by_patch.factors[k] == Approx(by_part.factors[k]).margin(1e-7));
    }
}

TEST_CASE("Merged parts: a patch whose parts have no area is covered", "[matrix]") {
    FormFactors factors = in_parts();
    factors.areas = {0.0, 0.0, 2.0};
    const FormFactors merged = merge_parts(std::move(factors));
    REQUIRE(merged.matrix.known(0));
    CHECK(merged.matrix.row(0).columns.empty());
    CHECK(merged.matrix.row(0).environment == 0.0);
    CHECK(merged.matrix.row(0).blocked == 1.0);
}

TEST_CASE("Merged parts: a row is known where those of all its parts are", "[matrix]") {
    FormFactors factors = in_parts();
    factors.matrix = test::forget_rows(factors.matrix, {1});
    const FormFactors merged = merge_parts(std::move(factors));
    CHECK_FALSE(merged.matrix.known(0));
    CHECK(merged.matrix.known(2));
}

TEST_CASE("Merged parts: without parts nothing changes, and parts must fit the rows", "[matrix]") {
    FormFactors factors = in_parts();
    factors.parts = {};
    CHECK(merge_parts(factors).matrix.size() == 3);
    CHECK(merge_parts(factors).areas == factors.areas);
    factors.parts = {{0, 0}, {0}};
    CHECK_THROWS_AS(merge_parts(std::move(factors)), InvalidArgument);
}
