#include "engine/hemicube/row_accumulator.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace hemi;

TEST_CASE("RowAccumulator: shares never turn negative or vanish, whatever floats round away", "[engine]") {
    // One patch fills the hemicube but for a few texels that go to nothing or to back faces.
    const DeltaFormFactors weights(512);
    const std::vector<std::uint32_t> item_of_id{item_nothing, item_blocked, item_first_patch};
    RowAccumulator accumulator(item_of_id, 1);
    std::vector<std::uint32_t> ids(std::size_t{3} * 512 * 512);
    for (std::uint32_t texels = 0; texels < 64; ++texels) {
        std::fill(ids.begin(), ids.end(), 2u);
        for (std::uint32_t k = 0; k < texels; ++k) {
            ids[k * 7919u] = k % 3 == 0 ? 1 : 0;
        }
        accumulator.add(ids.data(), weights);
        const RowView row = accumulator.take();
        CHECK((texels > 0) == (row.blocked > 0.0));
        CHECK((texels > 1) == (row.environment > 0.0));
        CHECK(row.sum() + row.environment + row.blocked == Approx(1.0).margin(1e-9).epsilon(0));
    }
}

TEST_CASE("RowAccumulator: a look-up of ids gives the same row as ids that need none", "[engine]") {
    const DeltaFormFactors weights(32);
    const std::vector<std::uint32_t> identity{0, 1, 2, 3, 4};
    const std::vector<std::uint32_t> swapped{0, 1, 4, 3, 2};
    RowAccumulator plain(identity, 3);
    RowAccumulator turned(swapped, 3);
    std::vector<std::uint32_t> ids(std::size_t{3} * 32 * 32);
    std::vector<std::uint32_t> other(ids.size());
    for (std::size_t k = 0; k < ids.size(); ++k) {
        ids[k] = static_cast<std::uint32_t>((k * k / 7) % 5);
        other[k] = swapped[ids[k]];
    }
    plain.add(ids.data(), weights);
    turned.add(other.data(), weights);
    const RowView a = plain.take();
    const RowView b = turned.take();
    CHECK(std::vector<float>(a.values.begin(), a.values.end()) ==
          std::vector<float>(b.values.begin(), b.values.end()));
    CHECK(a.environment == b.environment);
}
