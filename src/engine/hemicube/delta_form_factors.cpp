#include "hemi/engine/delta_form_factors.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace hemi {

namespace {

// The form factor of a rectangle on a hemicube face is a difference of a corner function over its corners:
//   top (x, y):  G = [x/√(1+x²)·atan(y/√(1+x²)) + y/√(1+y²)·atan(x/√(1+y²))] / 2π
//   side (y, z): H = -atan(y/√(1+z²)) / (2π√(1+z²))
// Both are made of one function, a(s, t) = atan(t/√(1+s²)) / (2π√(1+s²)): G = x·a(x, y) + y·a(y, x) and
// H = -a(z, y). It is even in s and odd in t, so one quadrant of texel corners holds everything. Doubles are
// wide enough: corner values are below 0.25 and right to 1e-16, a unit of a weight is 2.3e-10.
class CornerFunctions {
public:
    explicit CornerFunctions(int half)
        : half_(half), values_(static_cast<std::size_t>(half + 1) * static_cast<std::size_t>(half + 1)) {
        for (int s = 0; s <= half; ++s) {
            const double inverse = 1.0 / std::hypot(1.0, coordinate(s));
            for (int t = 0; t <= half; ++t) {
                values_[index(s, t)] =
                    inverse * std::atan(coordinate(t) * inverse) * (0.5 * std::numbers::inv_pi);
            }
        }
    }

    // Arguments are signed corner numbers: coordinate times half.
    [[nodiscard]] double top(int x, int y) const {
        const int u = std::abs(x);
        const int v = std::abs(y);
        const double value = coordinate(u) * values_[index(u, v)] + coordinate(v) * values_[index(v, u)];
        return (x < 0) == (y < 0) ? value : -value;
    }
    [[nodiscard]] double side(int y, int z) const {
        const double value = values_[index(z, std::abs(y))];
        return y < 0 ? value : -value;
    }

private:
    [[nodiscard]] double coordinate(int corner) const { return static_cast<double>(corner) / half_; }
    [[nodiscard]] std::size_t index(int s, int t) const {
        return static_cast<std::size_t>(s) * static_cast<std::size_t>(half_ + 1) +
               static_cast<std::size_t>(t);
    }

    int half_;
    std::vector<double> values_;
};

/// The same for solid angles: a rectangle [0, x] x [0, y] at distance 1 is seen under
/// atan(x y / √(1+x²+y²)), of 2π in front of the plane.
class CornerAngles {
public:
    explicit CornerAngles(int half) : half_(half) {}

    [[nodiscard]] double top(int x, int y) const {
        const double u = static_cast<double>(x) / half_;
        const double v = static_cast<double>(y) / half_;
        return std::atan(u * v / std::sqrt(1.0 + u * u + v * v)) * (0.5 * std::numbers::inv_pi);
    }
    [[nodiscard]] double side(int y, int z) const { return top(y, z); }

private:
    int half_;
};

} // namespace

void DeltaFormFactors::check_resolution(std::uint32_t resolution) {
    if (resolution < 2 || resolution > 4096 || resolution % 2 != 0) {
        throw InvalidArgument(
            fmt::format("hemicube resolution {}; it must be even, from 2 to 4096", resolution));
    }
}

DeltaFormFactors::DeltaFormFactors(std::uint32_t resolution, DirectionMeasure measure)
    : resolution_(resolution) {
    check_resolution(resolution);
    const int half = static_cast<int>(resolution / 2);
    if (measure == DirectionMeasure::projected_solid_angle) {
        sum_up(CornerFunctions(half));
    } else {
        sum_up(CornerAngles(half));
    }
}

template <class Corners>
void DeltaFormFactors::sum_up(const Corners& corners) {
    const int half = static_cast<int>(resolution_ / 2);
    prefix_.resize(std::size_t{rows()} * (resolution_ + 1));

    // One running sum over all texels in layout order, rounded where it is stored: every weight is then right
    // to one unit, and nothing is lost between rows and faces.
    double sum = 0.0;
    std::size_t next = 0;
    const auto add_row = [&](const auto& strip) {
        const double left = strip(-half);
        double value = sum;
        for (int corner = -half; corner <= half; ++corner) {
            value = std::max(value, sum + (strip(corner) - left));
            prefix_[next++] =
                static_cast<std::uint32_t>(std::min(value * total + 0.5, static_cast<double>(total)));
        }
        sum = value;
    };
    for (int y = -half; y < half; ++y) {
        add_row([&](int x) { return corners.top(x, y + 1) - corners.top(x, y); });
    }
    for (int face = 0; face < 4; ++face) {
        for (int z = 0; z < half; ++z) {
            add_row([&](int y) { return corners.side(y, z + 1) - corners.side(y, z); });
        }
    }
    prefix_.back() = total;
}

DeltaFormFactors DeltaFormFactors::scaled(double share) const {
    DeltaFormFactors result = *this;
    const auto factor = static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * 0x1p32);
    for (std::uint32_t& prefix : result.prefix_) {
        prefix = static_cast<std::uint32_t>(prefix * factor >> 32); // monotonous, as before
    }
    return result;
}

} // namespace hemi
