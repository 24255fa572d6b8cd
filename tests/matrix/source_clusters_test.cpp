#include "hemi/core/error.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/expansion.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/matrix/repair.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "hemi/solver/solver.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <vector>

using namespace hemi;
using Catch::Matchers::Contains;

namespace {

using Node = SourceClusters::Node;

/// Patches 2 and 0 in node 1, patches 1 and 3 in node 2, single ones in nodes 3 to 6.
std::shared_ptr<const SourceClusters> four_patches() {
    return std::make_shared<SourceClusters>(
        std::vector<std::uint32_t>{2, 0, 1, 3},
        std::vector<Node>{{0, 4, 1}, {0, 2, 3}, {2, 4, 5}, {0, 1, 0}, {1, 2, 0}, {2, 3, 0}, {3, 4, 0}},
        std::vector<double>{1.0, 2.0, 3.0, 6.0});
}

/// Row 0 sees patch 1 and node 2 (patches 1 and 3); row 1 sees node 1; rows 2 and 3 see nothing.
FormFactorMatrix rows_of_four() {
    FormFactorMatrix matrix(4, four_patches());
    std::vector<RowBlock> blocks = matrix.take_blocks();
    blocks[0].begin = {0, 2, 3, 3, 3};
    blocks[0].columns = {1, 6, 5};
    blocks[0].values = {0.25F, 0.5F, 0.75F};
    blocks[0].environment = {0.25, 0.25, 1.0, 1.0};
    blocks[0].known = {1, 1, 1, 1};
    matrix.set_block(std::move(blocks[0]));
    return matrix;
}

} // namespace

TEST_CASE("a cluster gives off the mean of its patches, by area") {
    const auto clusters = four_patches();
    std::vector<double> values{10.0, 20.0, 30.0, 40.0};
    values.resize(4 + clusters->nodes().size());
    clusters->fill(values, 1);
    CHECK(values[4] == Approx((10.0 + 40.0 + 90.0 + 240.0) / 12.0));
    CHECK(values[5] == Approx((90.0 + 10.0) / 4.0));
    CHECK(values[6] == Approx((40.0 + 240.0) / 8.0));
    CHECK(std::vector<double>(values.begin() + 7, values.end()) ==
          std::vector<double>{30.0, 10.0, 20.0, 40.0});
    CHECK(clusters->share(3, 2) == 0.75);
    CHECK(clusters->share(3, 0) == 0.5);
    CHECK_THROWS_AS(clusters->fill(std::span(values).first(4), 1), InvalidArgument);
}

TEST_CASE("clusters are a tree of all patches, each once") {
    const std::vector<double> areas{1.0, 1.0};
    const std::vector<Node> pair{{0, 2, 1}, {0, 1, 0}, {1, 2, 0}};
    CHECK_NOTHROW(SourceClusters({1, 0}, pair, areas));
    CHECK_NOTHROW(SourceClusters({}, {}, {}));
    const auto refused = [&](std::vector<std::uint32_t> order, std::vector<Node> nodes) {
        CHECK_THROWS_AS(SourceClusters(std::move(order), std::move(nodes), areas), InvalidArgument);
    };
    refused({0, 0}, pair);
    refused({0, 2}, pair);
    refused({0, 1}, {{0, 2, 1}, {0, 1, 0}});
    refused({0, 1}, {{0, 2, 0}});
    refused({0, 1}, {{0, 2, 1}, {0, 1, 0}, {0, 1, 0}});
    refused({0, 1}, {{0, 2, 1}, {0, 1, 0}, {1, 2, 0}, {0, 1, 0}});
    refused({0, 1}, {{0, 1, 0}});
    CHECK_THROWS_AS(SourceClusters({0, 1}, pair, std::vector<double>{1.0}), InvalidArgument);
}

TEST_CASE("rows of clusters gather, and share out what comes from a cluster") {
    const FormFactorMatrix matrix = rows_of_four();
    CHECK(matrix.columns() == 11);
    std::vector<double> product(4);
    multiply(matrix, std::vector<double>{10.0, 20.0, 30.0, 40.0}, 1, product);
    CHECK(product[0] == Approx(0.25 * 20.0 + 0.5 * 35.0));
    CHECK(product[1] == Approx(0.75 * 25.0));
    CHECK(product[2] == 0.0);

    std::vector<double> of_patch(4);
    visit_sources(matrix, matrix.row(0), [&](std::uint32_t j, double value) { of_patch[j] += value; });
    CHECK(of_patch == std::vector<double>{0.0, 0.375, 0.0, 0.375});
    const GroupFactors groups = group_factors(matrix, std::vector<double>{1.0, 2.0, 3.0, 6.0},
                                              std::vector<std::uint32_t>{0, 1, 1, 1}, 2);
    CHECK(groups.factors[1] == Approx(0.75));
}

TEST_CASE("rows of clusters are expanded to single patches by weight, if these fit") {
    const FormFactorMatrix matrix = rows_of_four();
    CHECK_THROWS_WITH(expand_clusters(matrix, 5 * 8 - 1), Contains("far patches stand in clusters"));
    const FormFactorMatrix single = expand_clusters(matrix, 5 * 8);
    CHECK(single.clusters() == nullptr);
    CHECK(single.columns() == 4);
    CHECK(single.all_known());
    const RowView first = single.row(0); // patch 1 on its own and in node 2, with a quarter of its weight
    CHECK(std::vector<std::uint32_t>(first.columns.begin(), first.columns.end()) ==
          std::vector<std::uint32_t>{1, 3});
    CHECK(std::vector<float>(first.values.begin(), first.values.end()) == std::vector<float>{0.375F, 0.375F});
    CHECK(first.environment == 0.25);
    const RowView second = single.row(1);
    CHECK(std::vector<std::uint32_t>(second.columns.begin(), second.columns.end()) ==
          std::vector<std::uint32_t>{0, 2});
    CHECK(second.values[0] == 0.1875F);
    CHECK(second.sum() == Approx(0.75));
    const std::vector<double> radiosity{10.0, 20.0, 30.0, 40.0};
    std::vector<double> by_clusters(4);
    std::vector<double> by_patches(4);
    multiply(matrix, radiosity, 1, by_clusters);
    multiply(single, radiosity, 1, by_patches);
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(by_patches[i] == Approx(by_clusters[i]));
    }
}

TEST_CASE("what needs pairs of patches refuses clusters") {
    FormFactorMatrix matrix = rows_of_four();
    const std::vector<double> areas{1.0, 2.0, 3.0, 6.0};
    CHECK_THROWS_WITH(reciprocity(matrix, areas), Contains("clusters of sources are one-way"));
    CHECK_THROWS_WITH(repair(matrix, areas, Repair::closure), Contains("repair closure: rows of clusters"));
    CHECK(repair(matrix, areas, Repair::none).row_error_after.max == 0.0);
    CHECK_THROWS_AS(FormFactorMatrix(3, four_patches()), InvalidArgument);
    std::vector<RowBlock> blocks = FormFactorMatrix(4).take_blocks();
    blocks[0].known[0] = 1;
    blocks[0].begin = {0, 1, 1, 1, 1};
    blocks[0].columns = {11};
    blocks[0].values = {0.5F};
    CHECK_THROWS_WITH(matrix.set_block(blocks[0]), Contains("be below 11"));
}

TEST_CASE("sweeps solve rows of clusters as they solve those of single patches") {
    const FormFactorMatrix matrix = rows_of_four();
    const std::vector<double> reflectance{0.5, 0.8, 0.0, 0.0};
    const std::vector<double> exitance{0.0, 0.0, 3.0, 1.0};
    const std::vector<double> environment{2.0};
    const std::vector<double> areas{1.0, 2.0, 3.0, 6.0};
    const RadiosityProblem problem{&matrix, 1, reflectance, exitance, environment, areas, {}};
    // B0 = 0.5 (0.25 B1 + 0.5 (2 B1 + 6) / 8 + 0.5), B1 = 0.8 (0.75 (9 + B0) / 4 + 0.5)
    const double b0 = (0.5 * (0.375 + 0.5) + 0.1875 * 0.8 * (6.75 / 4 + 0.5)) / (1.0 - 0.1875 * 0.8 * 0.1875);
    const double b1 = 0.8 * (0.75 * (9.0 + b0) / 4.0 + 0.5);
    for (const SolverMethod method :
         {SolverMethod::automatic, SolverMethod::gauss_seidel, SolverMethod::jacobi}) {
        SolverSettings settings;
        settings.method = method;
        settings.tolerance = 1e-12;
        const Solution solution = solve_radiosity(problem, settings);
        CHECK(solution.radiosity[0] == Approx(b0).epsilon(1e-10));
        CHECK(solution.radiosity[1] == Approx(b1).epsilon(1e-10));
        CHECK(irradiance(problem, solution.radiosity)[1] == Approx(b1 / 0.8).epsilon(1e-10));
    }
    SolverSettings gradients;
    gradients.method = SolverMethod::conjugate_gradient;
    CHECK_THROWS_WITH(solve_radiosity(problem, gradients), Contains("clusters of sources"));
}
