#include "hemi/engine/row_provider.hpp"

#include "hemi/core/error.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Hands out the rows of a matrix in a given order.
class FakeProvider : public RowProvider {
public:
    enum class Order { ascending, last_block_first, interleaved };

    FakeProvider(const FormFactorMatrix& matrix, Order order) : matrix_(matrix), order_(order) {}

    [[nodiscard]] std::uint32_t size() const override { return matrix_.size(); }
    [[nodiscard]] std::string renderer() const override { return "fake"; }

    void rows(std::span<const std::uint32_t> patches, const RowSink& sink) override {
        asked.emplace_back(patches.begin(), patches.end());
        std::vector<std::uint32_t> sequence(patches.begin(), patches.end());
        const auto key = [this](std::uint32_t patch) {
            const std::uint32_t block = patch / FormFactorMatrix::block_rows;
            const std::uint32_t local = patch % FormFactorMatrix::block_rows;
            return order_ == Order::ascending          ? std::pair(block, local)
                   : order_ == Order::last_block_first ? std::pair(~block, local)
                                                       : std::pair(local, block);
        };
        std::sort(sequence.begin(), sequence.end(),
                  [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
        for (const std::uint32_t patch : sequence) {
            sink(patch, matrix_.row(patch));
            ++delivered;
        }
        for (const std::uint32_t patch : extra) {
            sink(patch, matrix_.row(patch));
        }
    }

    std::vector<std::vector<std::uint32_t>> asked;
    std::vector<std::uint32_t> extra; ///< rows delivered after those asked for
    std::size_t delivered = 0;

private:
    const FormFactorMatrix& matrix_;
    Order order_;
};

FormFactorMatrix source_matrix() {
    std::vector<double> environment(200);
    std::iota(environment.begin(), environment.end(), 0.0);
    for (double& share : environment) {
        share /= 1000.0;
    }
    return dense_matrix(random_rows(200, 0.8, 9), environment, std::vector<double>(200, 0.1));
}

void check_same_row(const RowView& one, const RowView& other) {
    CHECK(std::equal(one.columns.begin(), one.columns.end(), other.columns.begin(), other.columns.end()));
    CHECK(std::equal(one.values.begin(), one.values.end(), other.values.begin(), other.values.end()));
    CHECK(one.environment == other.environment);
    CHECK(one.blocked == other.blocked);
}

} // namespace

TEST_CASE("compute_matrix: the same matrix whatever the order of the blocks", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    for (const auto order : {FakeProvider::Order::ascending, FakeProvider::Order::last_block_first,
                             FakeProvider::Order::interleaved}) {
        FakeProvider provider(source, order);
        const FormFactorMatrix matrix = compute_matrix(provider);
        CHECK(matrix.all_known());
        CHECK(matrix.entries() == source.entries());
        for (std::uint32_t i = 0; i < source.size(); ++i) {
            check_same_row(matrix.row(i), source.row(i));
        }
        for (const RowBlock& block : matrix.blocks()) {
            CHECK(block.columns.capacity() <= block.columns.size() + block.columns.size() / 8);
            CHECK(block.values.capacity() <= block.values.size() + block.values.size() / 8);
        }
    }
}

TEST_CASE("compute_matrix: rows that are not asked for stay unknown", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    const std::vector<std::uint32_t> patches{0, 5, 6, 63, 130, 199};
    FakeProvider provider(source, FakeProvider::Order::last_block_first);
    const FormFactorMatrix matrix = compute_matrix(provider, patches);
    for (std::uint32_t i = 0; i < source.size(); ++i) {
        if (std::find(patches.begin(), patches.end(), i) != patches.end()) {
            CHECK(matrix.known(i));
            check_same_row(matrix.row(i), source.row(i));
        } else {
            CHECK_FALSE(matrix.known(i));
            check_same_row(matrix.row(i), RowView{});
        }
    }
    CHECK(matrix.blocks()[1].columns.empty());
}

TEST_CASE("compute_matrix: no rows asked for is an unknown matrix", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    FakeProvider provider(source, FakeProvider::Order::ascending);
    const FormFactorMatrix matrix = compute_matrix(provider, std::vector<std::uint32_t>{});
    CHECK(matrix.size() == 200);
    CHECK(matrix.entries() == 0);
}

TEST_CASE("compute_matrix: progress counts every row", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    FakeProvider provider(source, FakeProvider::Order::last_block_first);
    std::size_t calls = 0;
    (void)compute_matrix(provider, [&](std::size_t done, std::size_t total) {
        CHECK(total == 200);
        CHECK(done == ++calls);
        return true;
    });
    CHECK(calls == 200);
}

TEST_CASE("compute_matrix: stops at once when progress says so", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    FakeProvider provider(source, FakeProvider::Order::ascending);
    CHECK_THROWS_AS(compute_matrix(provider, [](std::size_t done, std::size_t) { return done < 70; }),
                    Cancelled);
    CHECK(provider.delivered == 69); // the 70th is not taken
}

TEST_CASE("compute_matrix: refuses lists of rows that do not ascend", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    FakeProvider provider(source, FakeProvider::Order::ascending);
    CHECK_THROWS_AS(compute_matrix(provider, std::vector<std::uint32_t>{3, 2}), InvalidArgument);
    CHECK_THROWS_AS(compute_matrix(provider, std::vector<std::uint32_t>{3, 3}), InvalidArgument);
    CHECK_THROWS_AS(compute_matrix(provider, std::vector<std::uint32_t>{200}), InvalidArgument);
    CHECK(provider.asked.empty());
}

TEST_CASE("compute_matrix: a row that comes twice, unasked or not at all is an error", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    const std::vector<std::uint32_t> patches{1, 2, 70};
    for (const std::uint32_t extra : {1u, 3u, 150u}) {
        FakeProvider provider(source, FakeProvider::Order::ascending);
        provider.extra = {extra};
        CHECK_THROWS_AS(compute_matrix(provider, patches), Error);
    }

    class Lazy : public FakeProvider {
    public:
        using FakeProvider::FakeProvider;
        void rows(std::span<const std::uint32_t> wanted, const RowSink& sink) override {
            FakeProvider::rows(wanted.first(wanted.size() - 1), sink);
        }
    };
    Lazy lazy(source, FakeProvider::Order::ascending);
    CHECK_THROWS_WITH(compute_matrix(lazy, patches), Catch::Contains("2 of 3 rows"));
}

TEST_CASE("estimate_matrix: samples rows spread evenly and adds a margin", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    std::vector<std::uint32_t> patches(200);
    std::iota(patches.begin(), patches.end(), 0u);

    FakeProvider provider(source, FakeProvider::Order::ascending);
    const MatrixEstimate estimate = estimate_matrix(provider, patches, 4);
    CHECK(provider.asked.back() == std::vector<std::uint32_t>{25, 75, 125, 175});
    CHECK(estimate.seconds >= 0.0);

    FakeProvider complete(source, FakeProvider::Order::ascending);
    const MatrixEstimate exact = estimate_matrix(complete, patches, 1000);
    CHECK(complete.asked.back() == patches);
    CHECK(exact.entries_per_row == Approx(static_cast<double>(source.entries()) / 200));
    CHECK(static_cast<double>(exact.memory_bytes) ==
          Approx(1.2 * static_cast<double>(compute_matrix(complete).memory_bytes())).epsilon(0.01));
}

TEST_CASE("estimate_matrix: nothing to do needs no time", "[engine]") {
    const FormFactorMatrix source = source_matrix();
    FakeProvider provider(source, FakeProvider::Order::ascending);
    const MatrixEstimate estimate = estimate_matrix(provider, std::vector<std::uint32_t>{});
    CHECK(estimate.entries_per_row == 0.0);
    CHECK(estimate.seconds == 0.0);
    CHECK(provider.asked.empty());
}
