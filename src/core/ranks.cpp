#include "hemi/core/ranks.hpp"

namespace hemi {

namespace {

/// A process by itself.
class Alone final : public Ranks {
public:
    [[nodiscard]] std::uint32_t rank() const noexcept override { return 0; }
    [[nodiscard]] std::uint32_t size() const noexcept override { return 1; }
    [[nodiscard]] std::uint32_t on_machine() const noexcept override { return 1; }
    [[nodiscard]] std::vector<std::vector<std::byte>> gather(std::span<const std::byte> own) override {
        return {{own.begin(), own.end()}};
    }
    [[nodiscard]] bool meet() noexcept override { return true; }
};

Ranks* installed = nullptr;

} // namespace

Ranks& ranks() noexcept {
    static Alone alone;
    return installed != nullptr ? *installed : alone;
}

void set_ranks(Ranks* ranks) noexcept {
    installed = ranks;
}

} // namespace hemi
