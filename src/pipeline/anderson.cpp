#include "pipeline/anderson.hpp"

#include <cmath>
#include <numeric>

namespace hemi {

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void subtract(std::vector<double>& from, double factor, std::span<const double> what) {
    for (std::size_t i = 0; i < from.size(); ++i) {
        from[i] -= factor * what[i];
    }
}

std::vector<double> difference(std::span<const double> a, std::span<const double> b) {
    std::vector<double> result(a.begin(), a.end());
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] -= b[i];
    }
    return result;
}

} // namespace

std::vector<double> Anderson::next(std::span<const double> x, std::span<const double> g) {
    std::vector<double> f = difference(g, x);
    if (!x_.empty()) {
        dx_.push_back(difference(x, x_));
        df_.push_back(difference(f, f_));
        if (dx_.size() > window_) {
            dx_.erase(dx_.begin());
            df_.erase(df_.begin());
        }
    }
    x_.assign(x.begin(), x.end());
    f_ = f;
    std::vector<double> result(g.begin(), g.end());
    // Gram-Schmidt, the latest first: what is hardly new in those before is left out.
    std::vector<std::vector<double>> basis;
    std::vector<std::vector<double>> steps;
    for (std::size_t k = df_.size(); k-- > 0;) {
        std::vector<double> direction = df_[k];
        std::vector<double> step = dx_[k];
        for (std::size_t i = 0; i < step.size(); ++i) {
            step[i] += df_[k][i];
        }
        const double before = std::sqrt(dot(direction, direction));
        for (int pass = 0; pass < 2; ++pass) {
            for (std::size_t b = 0; b < basis.size(); ++b) {
                const double part = dot(basis[b], direction);
                subtract(direction, part, basis[b]);
                subtract(step, part, steps[b]);
            }
        }
        const double length = std::sqrt(dot(direction, direction));
        constexpr double independent = 1e-10;
        if (!(length > independent * before)) {
            continue;
        }
        for (std::size_t i = 0; i < step.size(); ++i) {
            direction[i] /= length;
            step[i] /= length;
        }
        basis.push_back(std::move(direction));
        steps.push_back(std::move(step));
        const double part = dot(basis.back(), f);
        subtract(f, part, basis.back());
        subtract(result, part, steps.back());
    }
    return result;
}

} // namespace hemi
