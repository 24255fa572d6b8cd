#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hemi {

/// The squared error of patches from two signs of it: a sum of both, neither below 0, that agrees best with a
/// sample, relative to what the signs are there; then scaled to the sample's whole.
class PatchErrorModel {
public:
    /// Squared, as the error.
    using Signs = std::array<double, 2>;

    /// @param signs   of a patch of the sample
    /// @param square  of its error
    /// @param area    that it stands for
    void add(const Signs& signs, double square, double area) { sample_.push_back({signs, square, area}); }

    /// When the sample is complete.
    void fit() {
        std::array<std::array<double, 2>, 2> products{};
        Signs right{};
        for (const Entry& entry : sample_) {
            const double weight = entry.area / std::pow(entry.signs[0] + entry.signs[1], 2.0);
            for (std::size_t a = 0; a < 2; ++a) {
                for (std::size_t b = 0; b < 2; ++b) {
                    products[a][b] += weight * entry.signs[a] * entry.signs[b];
                }
                right[a] += weight * entry.signs[a] * entry.square;
            }
        }
        shares_ = least_squares(products, right);
        double expected = 0.0;
        double found = 0.0;
        for (const Entry& entry : sample_) {
            expected += entry.area * square(entry.signs);
            found += entry.area * entry.square;
        }
        const double scale = expected > 0.0 ? found / expected : 0.0;
        shares_ = {scale * shares_[0], scale * shares_[1]};
    }

    /// Of a patch with these signs.
    [[nodiscard]] double square(const Signs& signs) const {
        return shares_[0] * signs[0] + shares_[1] * signs[1];
    }

private:
    struct Entry {
        Signs signs;
        double square;
        double area;
    };

    /// Of two equations, the solution without negative numbers that comes nearest.
    static Signs least_squares(const std::array<std::array<double, 2>, 2>& products, const Signs& right) {
        const double determinant = products[0][0] * products[1][1] - products[0][1] * products[1][0];
        if (determinant > 1e-9 * products[0][0] * products[1][1]) {
            const double first = (right[0] * products[1][1] - right[1] * products[0][1]) / determinant;
            const double second = (right[1] * products[0][0] - right[0] * products[1][0]) / determinant;
            if (first >= 0.0 && second >= 0.0) {
                return {first, second};
            }
            // One of them alone explains more.
            if (second < 0.0 || first > second) {
                return {right[0] / products[0][0], 0.0};
            }
            return {0.0, right[1] / products[1][1]};
        }
        return {products[0][0] > 0.0 ? right[0] / products[0][0] : 0.0, 0.0};
    }

    std::vector<Entry> sample_;
    Signs shares_{};
};

} // namespace hemi
