#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace hemi::test {

/// Rows of a matrix, written out.
using DenseRows = std::vector<std::vector<double>>;

/// Uniform in [0, 1), the same numbers with every standard library.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

private:
    std::mt19937_64 engine_;
};

/// Block `first_row` of the matrix; zeros are not stored. Every row is known.
/// @param environment,blocked  per row of the whole matrix; empty: zero
inline RowBlock dense_block(const DenseRows& rows, std::uint32_t first_row,
                            const std::vector<double>& environment = {},
                            const std::vector<double>& blocked = {}) {
    RowBlock block;
    block.first_row = first_row;
    block.begin.push_back(0);
    const std::size_t end = std::min<std::size_t>(rows.size(), first_row + FormFactorMatrix::block_rows);
    for (std::size_t i = first_row; i < end; ++i) {
        for (std::size_t j = 0; j < rows[i].size(); ++j) {
            if (rows[i][j] != 0.0) {
                block.columns.push_back(static_cast<std::uint32_t>(j));
                block.values.push_back(static_cast<float>(rows[i][j]));
            }
        }
        block.begin.push_back(block.columns.size());
        block.environment.push_back(environment.empty() ? 0.0 : environment[i]);
        block.blocked.push_back(blocked.empty() ? 0.0 : blocked[i]);
        block.known.push_back(1);
    }
    return block;
}

inline FormFactorMatrix dense_matrix(const DenseRows& rows, const std::vector<double>& environment = {},
                                     const std::vector<double>& blocked = {}) {
    FormFactorMatrix matrix(static_cast<std::uint32_t>(rows.size()));
    for (std::size_t first = 0; first < rows.size(); first += FormFactorMatrix::block_rows) {
        matrix.set_block(dense_block(rows, static_cast<std::uint32_t>(first), environment, blocked));
    }
    return matrix;
}

/// The matrix with rows `i` of `unknown` forgotten.
inline FormFactorMatrix forget_rows(const FormFactorMatrix& matrix,
                                    const std::vector<std::uint32_t>& unknown) {
    FormFactorMatrix result(matrix.size());
    for (const RowBlock& block : matrix.blocks()) {
        RowBlock kept;
        kept.first_row = block.first_row;
        kept.begin.push_back(0);
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            const std::uint32_t i = block.first_row + local;
            const bool known = std::find(unknown.begin(), unknown.end(), i) == unknown.end();
            if (known) {
                const RowView row = matrix.row(i);
                kept.columns.insert(kept.columns.end(), row.columns.begin(), row.columns.end());
                kept.values.insert(kept.values.end(), row.values.begin(), row.values.end());
            }
            kept.begin.push_back(kept.columns.size());
            kept.environment.push_back(known ? block.environment[local] : 0.0);
            kept.blocked.push_back(known ? block.blocked[local] : 0.0);
            kept.known.push_back(known ? 1 : 0);
        }
        result.set_block(std::move(kept));
    }
    return result;
}

/// Sparse rows of random values (a diagonal among them) with the given sum.
inline DenseRows random_rows(std::uint32_t size, double row_sum, std::uint64_t seed) {
    Random random(seed);
    DenseRows rows(size, std::vector<double>(size, 0.0));
    for (std::uint32_t i = 0; i < size; ++i) {
        double sum = 0.0;
        for (double& value : rows[i]) {
            value = random() < 0.4 ? random() : 0.0;
            sum += value;
        }
        rows[i][(i + 1) % size] += 1.0;
        sum += 1.0;
        for (double& value : rows[i]) {
            value *= row_sum / sum;
        }
    }
    return rows;
}

/// Areas and rows with A_i F(i, j) = A_j F(j, i) and row sums of at most 1.
struct ReciprocalScene {
    std::vector<double> areas;
    DenseRows rows;
};

inline ReciprocalScene reciprocal_scene(std::uint32_t size, std::uint64_t seed) {
    Random random(seed);
    ReciprocalScene scene;
    scene.rows.assign(size, std::vector<double>(size, 0.0));
    for (std::uint32_t i = 0; i < size; ++i) {
        scene.areas.push_back(0.5 + random());
        for (std::uint32_t j = 0; j < i; ++j) {
            const double exchange = random() < 0.5 ? random() / (2.0 * size) : 0.0;
            scene.rows[i][j] = exchange;
            scene.rows[j][i] = exchange;
        }
    }
    for (std::uint32_t i = 0; i < size; ++i) {
        for (double& value : scene.rows[i]) {
            value /= scene.areas[i];
        }
    }
    return scene;
}

/// A_i F(i, j) of the scene's pairs.
inline DenseRows exchange_of(const ReciprocalScene& scene) {
    DenseRows exchange = scene.rows;
    for (std::size_t i = 0; i < exchange.size(); ++i) {
        for (double& value : exchange[i]) {
            value *= scene.areas[i];
        }
    }
    return exchange;
}

inline ReciprocalScene scene_of(const DenseRows& exchange, const std::vector<double>& areas) {
    ReciprocalScene scene{areas, exchange};
    for (std::size_t i = 0; i < areas.size(); ++i) {
        for (double& value : scene.rows[i]) {
            value /= areas[i];
        }
    }
    return scene;
}

/// Scales symmetric exchange areas until row i sums to `targets[i]`: x_ij = s_i s_j m_ij.
inline void scale_to_targets(DenseRows& exchange, const std::vector<double>& targets) {
    for (int sweep = 0; sweep < 2000; ++sweep) {
        std::vector<double> scale(exchange.size());
        for (std::size_t i = 0; i < exchange.size(); ++i) {
            double sum = 0.0;
            for (const double value : exchange[i]) {
                sum += value;
            }
            scale[i] = sum > 0.0 ? std::sqrt(targets[i] / sum) : 1.0;
        }
        for (std::size_t i = 0; i < exchange.size(); ++i) {
            for (std::size_t j = 0; j < exchange.size(); ++j) {
                exchange[i][j] *= scale[i] * scale[j];
            }
        }
    }
}

/// Areas between 1 and `ratio` and rows with A_i F(i, j) = A_j F(j, i) that sum to 1. Half of the pairs see
/// each other.
inline ReciprocalScene closed_scene(std::uint32_t size, std::uint64_t seed, double ratio = 2.0) {
    Random random(seed);
    std::vector<double> areas;
    DenseRows exchange(size, std::vector<double>(size, 0.0));
    for (std::uint32_t i = 0; i < size; ++i) {
        areas.push_back(std::pow(ratio, random()));
        for (std::uint32_t j = 0; j < i; ++j) {
            const double value = random() < 0.5 ? (0.1 + random()) * areas[i] * areas[j] : 0.0;
            exchange[i][j] = exchange[j][i] = value;
        }
    }
    scale_to_targets(exchange, areas);
    return scene_of(exchange, areas);
}

/// The matrix with a code of visibility for every entry.
template <class Code>
FormFactorMatrix with_visibility(FormFactorMatrix matrix, const Code& code_of) {
    for (RowBlock& block : matrix.take_blocks()) {
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            for (std::uint64_t k = block.begin[local]; k < block.begin[local + 1]; ++k) {
                block.visibility.push_back(code_of(block.first_row + local, block.columns[k]));
            }
        }
        matrix.set_block(std::move(block));
    }
    return matrix;
}

} // namespace hemi::test
