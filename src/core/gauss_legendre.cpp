#include "core/gauss_legendre.hpp"

#include <cmath>
#include <numbers>

namespace hemi {

std::vector<GaussPoint> gauss_legendre(std::uint32_t count) {
    std::vector<GaussPoint> points(count);
    for (std::uint32_t k = 0; k < (count + 1) / 2; ++k) {
        // Newton's method on the Legendre polynomial, from Tricomi's estimate of its k-th root.
        double x = std::cos(std::numbers::pi * (k + 0.75) / (count + 0.5));
        double slope = 1.0;
        for (int step = 0; step < 100; ++step) {
            double p = 1.0;
            double before = 0.0;
            for (std::uint32_t n = 1; n <= count; ++n) {
                const double next = ((2.0 * n - 1.0) * x * p - (n - 1.0) * before) / n;
                before = p;
                p = next;
            }
            slope = count * (x * p - before) / (x * x - 1.0);
            const double change = p / slope;
            x -= change;
            if (std::abs(change) < 1e-15) {
                break;
            }
        }
        const double weight = 1.0 / ((1.0 - x * x) * slope * slope);
        points[k] = {0.5 * (1.0 - x), weight};
        points[count - 1 - k] = {0.5 * (1.0 + x), weight};
    }
    if (count % 2 == 1) {
        points[count / 2].at = 0.5;
    }
    return points;
}

} // namespace hemi
