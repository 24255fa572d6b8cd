#pragma once

#include "hemi/solver/solution.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace hemi {

/// A patch of the sample, with how many of its kind it stands for.
struct DrawnPatch {
    std::uint32_t patch;
    double weight;
};

/// Makes half of a sample follow `other`.
inline void mix_importance(std::vector<double>& importance, const std::vector<double>& other) {
    const double sum = std::accumulate(importance.begin(), importance.end(), 0.0);
    const double sum_of_other = std::accumulate(other.begin(), other.end(), 0.0);
    for (std::size_t k = 0; k < importance.size(); ++k) {
        importance[k] = importance[k] / sum + other[k] / sum_of_other;
    }
}

/// Draws about `count` of `patches` with probabilities that go like `importance`, spread over them in order.
inline std::vector<DrawnPatch> draw_sample(const std::vector<std::uint32_t>& patches,
                                           const std::vector<double>& importance, double count) {
    const double total = std::accumulate(importance.begin(), importance.end(), 0.0);
    std::vector<DrawnPatch> sample;
    double sum = 0.5;
    for (std::size_t k = 0; k < patches.size(); ++k) {
        const double probability = std::min(1.0, count * importance[k] / total);
        sum += probability;
        if (sum >= 1.0) {
            sum -= 1.0;
            sample.push_back({patches[k], 1.0 / probability});
        }
    }
    return sample;
}

/// Errors at quarters of patches, with the areas they stand for.
class SampledErrors {
public:
    void add(double error, double area) { errors_.push_back({std::abs(error), area}); }
    /// A patch of the sample is complete: what it adds to the variance of squares().
    /// @param weight  how many patches it stands for
    /// @param square  what it added to squares(), with that weight, less what was expected of it
    void end_patch(double weight, double square) { variance_ += (weight - 1.0) / weight * square * square; }

    /// Sum of their squares times areas.
    [[nodiscard]] double squares() const {
        double sum = 0.0;
        for (const auto& [error, area] : errors_) {
            sum += area * error * error;
        }
        return sum;
    }

    /// @param unit  what they are relative to
    /// @param more  by which the mean square is more than that of these errors
    /// @param rms_more  the same of the rms alone
    [[nodiscard]] FieldError summary(double unit, double more, double rms_more = 1.0) {
        double total = 0.0;
        for (const auto& [error, area] : errors_) {
            total += area;
        }
        FieldError result;
        if (!(total > 0.0)) {
            return result;
        }
        std::sort(errors_.begin(), errors_.end());
        const double scale = more * rms_more / total;
        result.rms = std::sqrt(scale * squares()) / unit;
        result.doubt = std::sqrt(scale * (squares() + std::sqrt(variance_))) / unit - result.rms;
        double below = 0.0;
        for (const auto& [error, area] : errors_) {
            result.percentile95 = std::sqrt(more) * error / unit;
            below += area;
            if (below >= 0.95 * total) {
                break;
            }
        }
        return result;
    }

private:
    std::vector<std::pair<double, double>> errors_;
    double variance_ = 0.0; ///< of the sum of squares
};

/// A sum over all patches, from those of a sample.
class SampledSum {
public:
    /// @param weight  how many of its kind the value stands for
    void add(double value, double weight) {
        sum_ += weight * value;
        variance_ += weight * (weight - 1.0) * value * value;
    }
    /// The sum's magnitude and its standard error, together. What was drawn for certain has none; of others
    /// the mean is taken to be 0, which is the safe side.
    [[nodiscard]] double with_standard_error() const { return std::sqrt(sum_ * sum_ + variance_); }

private:
    double sum_ = 0.0;
    double variance_ = 0.0;
};

} // namespace hemi
