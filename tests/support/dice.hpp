#pragma once

#include <cstdint>
#include <random>

namespace hemi::test {

/// Numbers between limits, the same everywhere.
class Dice {
public:
    explicit Dice(std::uint32_t seed) : engine_(seed) {}
    double operator()(double low, double high) {
        return low + (high - low) * static_cast<double>(engine_()) * 0x1p-32;
    }
    int pick(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }

private:
    std::mt19937 engine_;
};

} // namespace hemi::test
