#include "hemi/core/ranks.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace hemi;

namespace {

/// The second of three, of which the others have one value less and one more.
class Second final : public Ranks {
public:
    [[nodiscard]] std::uint32_t rank() const noexcept override { return 1; }
    [[nodiscard]] std::uint32_t size() const noexcept override { return 3; }
    [[nodiscard]] std::uint32_t on_machine() const noexcept override { return 3; }
    [[nodiscard]] std::vector<std::vector<std::byte>> gather(std::span<const std::byte> own) override {
        std::vector<std::byte> less(own.begin(), own.end());
        std::vector<std::byte> more(own.begin(), own.end());
        less.resize(own.size() - sizeof(std::uint32_t));
        more.resize(own.size() + sizeof(std::uint32_t));
        return {less, {own.begin(), own.end()}, more};
    }
    [[nodiscard]] bool meet() noexcept override { return true; }
};

} // namespace

TEST_CASE("Ranks: a process is alone until it is told otherwise", "[core]") {
    CHECK(ranks().rank() == 0);
    CHECK(ranks().size() == 1);
    CHECK(ranks().meet());
    const std::vector<double> own{1.0, 2.0};
    CHECK(gather_values(ranks(), std::span<const double>(own)) == own);
    Second second;
    set_ranks(&second);
    CHECK(ranks().rank() == 1);
    set_ranks(nullptr);
    CHECK(ranks().size() == 1);
}

TEST_CASE("Ranks: values of all come one after the other, however many each has", "[core]") {
    Second second;
    const std::vector<std::uint32_t> own{7, 8};
    CHECK(gather_values(second, std::span<const std::uint32_t>(own)) ==
          std::vector<std::uint32_t>{7, 7, 8, 7, 8, 0});
}
