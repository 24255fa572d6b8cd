#pragma once

#include "hemi/solver/solver.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace hemi::test {

/// A problem that owns its arrays.
struct OwnedProblem {
    FormFactorMatrix factors;
    std::uint32_t channels;
    std::vector<double> reflectance;
    std::vector<double> exitance;
    std::vector<double> environment;
    std::vector<double> areas = {};

    [[nodiscard]] RadiosityProblem view() const {
        return {&factors, channels, reflectance, exitance, environment, areas};
    }
};

/// The same reflectance and exitance everywhere.
inline OwnedProblem uniform_problem(FormFactorMatrix factors, double reflectance, double exitance) {
    const std::size_t size = factors.size();
    return {std::move(factors),
            1,
            std::vector<double>(size, reflectance),
            std::vector<double>(size, exitance),
            {}};
}

inline OwnedProblem random_problem(std::uint32_t size, std::uint32_t channels, std::uint64_t seed,
                                   double max_reflectance = 0.95) {
    Random random(seed);
    std::vector<double> environment(size);
    DenseRows rows = random_rows(size, 1.0, seed + 1);
    for (std::uint32_t i = 0; i < size; ++i) {
        environment[i] = random() < 0.5 ? 0.3 * random() : 0.0;
        for (double& value : rows[i]) {
            value *= 1.0 - environment[i];
        }
    }
    OwnedProblem problem{dense_matrix(rows, environment), channels, {}, {}, {}};
    for (std::size_t k = 0; k < std::size_t{size} * channels; ++k) {
        problem.reflectance.push_back(random() < 0.2 ? 0.0 : max_reflectance * random());
        problem.exitance.push_back(random() < 0.3 ? 10.0 * random() : 0.0);
    }
    for (std::uint32_t c = 0; c < channels; ++c) {
        problem.environment.push_back(random());
    }
    return problem;
}

/// Gaussian elimination with partial pivoting.
inline std::vector<double> solve_dense(DenseRows a, std::vector<double> b) {
    const std::size_t size = b.size();
    for (std::size_t k = 0; k < size; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < size; ++i) {
            pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
        }
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t i = k + 1; i < size; ++i) {
            const double factor = a[i][k] / a[k][k];
            for (std::size_t j = k; j < size; ++j) {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (std::size_t k = size; k-- > 0;) {
        for (std::size_t j = k + 1; j < size; ++j) {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    return b;
}

/// B by elimination, channel after channel.
inline std::vector<double> solve_dense(const OwnedProblem& problem) {
    const std::uint32_t size = problem.factors.size();
    std::vector<double> result(problem.exitance.size());
    for (std::uint32_t c = 0; c < problem.channels; ++c) {
        DenseRows a(size, std::vector<double>(size, 0.0));
        std::vector<double> b(size);
        for (std::uint32_t i = 0; i < size; ++i) {
            const RowView row = problem.factors.row(i);
            const double rho = problem.reflectance[i * problem.channels + c];
            for (std::size_t k = 0; k < row.columns.size(); ++k) {
                a[i][row.columns[k]] = -rho * static_cast<double>(row.values[k]);
            }
            // The rounding of the row to floats belongs to the patch itself.
            a[i][i] += 1.0 - rho * (1.0 - row.sum() - row.environment - row.blocked);
            b[i] = problem.exitance[i * problem.channels + c];
            if (!problem.environment.empty()) {
                b[i] += rho * row.environment * problem.environment[c];
            }
        }
        const std::vector<double> x = solve_dense(std::move(a), std::move(b));
        for (std::uint32_t i = 0; i < size; ++i) {
            result[i * problem.channels + c] = x[i];
        }
    }
    return result;
}

inline double largest_difference(const std::vector<double>& one, const std::vector<double>& other) {
    REQUIRE(one.size() == other.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < one.size(); ++k) {
        largest = std::max(largest, std::abs(one[k] - other[k]));
    }
    return largest;
}

inline bool same_bits(const std::vector<double>& one, const std::vector<double>& other) {
    return one.size() == other.size() &&
           std::memcmp(one.data(), other.data(), one.size() * sizeof(double)) == 0;
}

} // namespace hemi::test
