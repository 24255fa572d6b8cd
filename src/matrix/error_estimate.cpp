#include "hemi/matrix/error_estimate.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"
#include "hemi/matrix/source_clusters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

namespace hemi {

namespace {

/// Error of a factor from being stored as float, relative, rms: uniform up to 2^-24, so 1/sqrt(3) of that.
/// Rows and reference are rounded alike, so that comparing them does not show it.
constexpr double rounding = 0x1p-24 * 0.57735;

/// A code of 0 stands for half a step of V.
constexpr double min_visibility_code = 0.5;

/// Trust in the sample: variances of single rows are raised by 1 + 8/n, n being the number of sampled rows.
/// The relative standard deviation of a variance found from n normal values is sqrt(2/n): the factor allows
/// for one of them at 32 rows, the most of a usual sample, and 1.6 at 12, the fewest, since errors are not
/// normal. tests/pipeline/error_estimate_gl_test.cpp checks what comes of it against known factors.
constexpr double sample_allowance = 8.0;

/// The largest error of all is not in the sample: so much above what the sample's largest extrapolates to.
/// Chosen, and checked by the same tests.
constexpr double unsampled_allowance = 1.5;
/// Up to this ratio of two rows' largest factors their largest errors are taken to have the same ratio;
/// beyond, where noise does most, its root. Chosen, and checked by the same tests.
constexpr double proportional_ratio = 10.0;

/// Models of what the variance of a factor is proportional to: their values for one factor, or sums of them.
/// None holds everywhere; see models_of() and fit_variances().
constexpr std::size_t models = 3;
using VarianceModels = std::array<double, models>;
/// The models of a row's largest error: without and with visibility.
constexpr std::size_t square_model = 1;
constexpr std::size_t visibility_model = 2;

double visibility_of(const RowView& row, std::size_t entry) {
    return row.visibility.empty()
               ? 1.0
               : std::max(min_visibility_code, static_cast<double>(row.visibility[entry])) / visibility_clear;
}

/// Of one factor:
/// - F, as of a number of texels of about equal weight;
/// - F², a relative error;
/// - F0² V (1 - V) with F0 = F / V the unoccluded factor, as of a share of samples that are visible or not;
///   without visibility F⁴, of sample points that stand for patches near each other: a relative error that
///   grows with the solid angle.
VarianceModels models_of(const RowView& row, std::size_t entry) {
    const double factor = static_cast<double>(row.values[entry]);
    const double visibility = visibility_of(row, entry);
    const double square = factor * factor;
    return {factor, square,
            row.visibility.empty() ? square * square : square * (1.0 - visibility) / visibility};
}

/// Sums over the factors of a row, each times weight_j (none: 1).
VarianceModels sum_models(const RowView& row, std::span<const double> weights) {
    VarianceModels sums{};
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const VarianceModels of_factor = models_of(row, k);
        const double weight = weights.empty() ? 1.0 : weights[row.columns[k]];
        for (std::size_t m = 0; m < models; ++m) {
            sums[m] += of_factor[m] * weight;
        }
    }
    return sums;
}

/// The largest over the factors of a row.
VarianceModels largest_models(const RowView& row) {
    VarianceModels largest{};
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const VarianceModels of_factor = models_of(row, k);
        for (std::size_t m = 0; m < models; ++m) {
            largest[m] = std::max(largest[m], of_factor[m]);
        }
    }
    return largest;
}

/// Calls take(j, F(i, j) - F*(i, j), F*(i, j)) for all columns, or those of `columns`, where either is
/// stored.
template <class Take>
void compare(const RowView& row, const RowView& reference, std::span<const std::uint32_t> columns,
             const Take& take) {
    std::size_t a = 0;
    std::size_t b = 0;
    auto wanted = columns.begin();
    while (a < row.columns.size() || b < reference.columns.size()) {
        const std::uint32_t j = b == reference.columns.size() ||
                                        (a < row.columns.size() && row.columns[a] <= reference.columns[b])
                                    ? row.columns[a]
                                    : reference.columns[b];
        const bool found = a < row.columns.size() && row.columns[a] == j;
        const bool expected = b < reference.columns.size() && reference.columns[b] == j;
        const double is = found ? static_cast<double>(row.values[a++]) : 0.0;
        const double should = expected ? static_cast<double>(reference.values[b++]) : 0.0;
        if (!columns.empty()) {
            wanted = std::lower_bound(wanted, columns.end(), j);
            if (wanted == columns.end() || *wanted != j) {
                continue;
            }
        }
        take(j, is - should, should);
    }
}

/// A better row as far as another one tells sources apart: patches of a cluster stand together.
class ComparableRow {
public:
    /// @param factors    with or without clusters
    /// @param i          row
    /// @param reference  without clusters; must outlive this
    ComparableRow(const FormFactorMatrix& factors, std::uint32_t i, const FormFactorMatrix& reference)
        : view_(reference.row(i)) {
        if (factors.clusters() == nullptr) {
            return;
        }
        const std::uint32_t size = factors.size();
        std::vector<std::uint32_t> column_of(size);
        std::iota(column_of.begin(), column_of.end(), 0u);
        const RowView row = factors.row(i);
        for (const std::uint32_t column : row.columns) {
            if (column >= size) {
                for (const std::uint32_t patch : factors.clusters()->patches(column - size)) {
                    column_of[patch] = column;
                }
            }
        }
        std::map<std::uint32_t, double> sums;
        for (std::size_t k = 0; k < view_.columns.size(); ++k) {
            sums[column_of[view_.columns[k]]] += static_cast<double>(view_.values[k]);
        }
        for (const auto& [column, sum] : sums) {
            columns_.push_back(column);
            values_.push_back(static_cast<float>(sum));
        }
        view_.columns = columns_;
        view_.values = values_;
    }
    ComparableRow(const ComparableRow&) = delete;
    ComparableRow& operator=(const ComparableRow&) = delete;

    [[nodiscard]] const RowView& view() const { return view_; }

private:
    RowView view_;
    std::vector<std::uint32_t> columns_;
    std::vector<float> values_;
};

/// Values of the patches, with the means of the clusters of a matrix behind them.
std::vector<double> with_clusters(const FormFactorMatrix& factors, std::vector<double> values,
                                  std::size_t stride = 1) {
    if (factors.clusters() != nullptr) {
        values.resize(factors.columns() * stride);
        factors.clusters()->fill(values, stride);
    }
    return values;
}

/// Rows that are in both.
std::vector<std::uint32_t> sampled_rows(const FormFactorMatrix& factors, const FormFactorMatrix& reference) {
    if (factors.size() != reference.size()) {
        throw InvalidArgument(
            fmt::format("{} rows and a reference of {}; must be as many", factors.size(), reference.size()));
    }
    std::vector<std::uint32_t> rows;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (reference.known(i) && factors.known(i)) {
            rows.push_back(i);
        }
    }
    if (rows.empty()) {
        throw InvalidArgument("no row of the reference is known");
    }
    return rows;
}

/// Variances of all rows, each factor's times weight_j.
struct Variances {
    std::vector<double> mean;    ///< of the models: right in the sum
    std::vector<double> largest; ///< of the models: on the safe side in every row
    double common = 0.0;         ///< deviation that all rows have in common
};
/// Scales each model to the squared errors that the sampled rows have together.
/// @param measured  sum of squared errors of each row of `sampled`
/// @param weights   of the columns; may be empty
/// @param counts    what each row counts, N; may be empty: all the same
Variances fit_variances(const FormFactorMatrix& factors, std::span<const std::uint32_t> sampled,
                        std::span<const double> measured, std::span<const double> weights,
                        std::span<const double> counts) {
    std::vector<VarianceModels> of_row(factors.size());
    parallel_for(factors.size(), FormFactorMatrix::block_rows, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            of_row[i] = sum_models(factors.row(static_cast<std::uint32_t>(i)), weights);
        }
    });
    VarianceModels in_sample{};
    double variance = 0.0;
    for (std::size_t k = 0; k < sampled.size(); ++k) {
        const VarianceModels unweighted =
            weights.empty() ? of_row[sampled[k]] : sum_models(factors.row(sampled[k]), {});
        const double count = counts.empty() ? 1.0 : counts[sampled[k]];
        variance += count * measured[k];
        for (std::size_t m = 0; m < models; ++m) {
            in_sample[m] += count * unweighted[m];
        }
    }
    const auto used = static_cast<double>(
        std::count_if(in_sample.begin(), in_sample.end(), [](double sum) { return sum > 0.0; }));
    const double allowance = 1.0 + sample_allowance / static_cast<double>(sampled.size());
    Variances variances{std::vector<double>(factors.size()), std::vector<double>(factors.size()), 0.0};
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        for (std::size_t m = 0; m < models; ++m) {
            const double modelled = in_sample[m] > 0.0 ? variance * of_row[i][m] / in_sample[m] : 0.0;
            variances.mean[i] += modelled / std::max(1.0, used);
            variances.largest[i] = std::max(variances.largest[i], modelled * allowance);
        }
    }
    return variances;
}

/// The largest error of any factor: a row's goes like its largest factor, or partly hidden factor, where that
/// is not too far from the largest of all; beyond, noise does most, and goes like the root.
/// @param largest  of the rows `sampled`
double largest_factor_error(const FormFactorMatrix& factors, std::span<const std::uint32_t> sampled,
                            std::span<const double> largest) {
    const std::size_t model = factors.has_visibility() ? visibility_model : square_model;
    const auto strength = [&](std::uint32_t i) { return std::sqrt(largest_models(factors.row(i))[model]); };
    double strongest = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        strongest = std::max(strongest, strength(i));
    }
    double estimate = 0.0;
    for (std::size_t k = 0; k < sampled.size(); ++k) {
        const double here = strength(sampled[k]);
        const double reach = here > 0.0 ? strongest / here : 1.0;
        estimate = std::max(estimate, largest[k] * (reach < proportional_ratio ? reach : std::sqrt(reach)));
    }
    return std::min(1.0, unsampled_allowance * estimate);
}

/// How much of a row's squared error lies in the columns that are compared: their share of all.
double share_of(const FormFactorMatrix& factors, std::span<const std::uint32_t> columns) {
    return columns.empty() || factors.size() == 0
               ? 1.0
               : static_cast<double>(columns.size()) / static_cast<double>(factors.size());
}

/// What a row gathers, less what it gathers as single patches.
/// @param row      of single patches
/// @param joined   the same, in columns of patches and clusters
/// @param sources  values of both
double inside_clusters(const RowView& row, const RowView& joined, std::span<const double> sources) {
    const auto gather = [sources](const RowView& from) {
        double sum = 0.0;
        for (std::size_t k = 0; k < from.columns.size(); ++k) {
            sum += static_cast<double>(from.values[k]) * sources[from.columns[k]];
        }
        return sum;
    };
    return gather(joined) - gather(row);
}

/// Of the irradiance sum_j F(i, j) b_j. Rows sum to what they should nearly always, so that only what differs
/// from the mean of b counts; the sample says how much more it errs than if factors erred independently.
Variances irradiance_variances(const FormFactorMatrix& factors, const FormFactorMatrix& reference,
                               std::span<const std::uint32_t> columns, std::span<const std::uint32_t> sampled,
                               std::span<const double> areas, std::span<const double> b) {
    double all = 0.0;
    double even = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        all += areas[i];
        even += areas[i] * b[i];
    }
    even /= all;
    std::vector<double> weights(b.size());
    std::transform(b.begin(), b.end(), weights.begin(),
                   [even](double value) { return (value - even) * (value - even); });
    weights = with_clusters(factors, std::move(weights));
    const std::vector<double> sources = with_clusters(factors, {b.begin(), b.end()});
    const double share = share_of(factors, columns);
    std::vector<double> squares(sampled.size());
    double area = 0.0;
    double area_squares = 0.0;
    double mean = 0.0;
    double measured = 0.0;
    for (std::size_t k = 0; k < sampled.size(); ++k) {
        const double counts = areas[sampled[k]];
        double error = 0.0;
        const ComparableRow better(factors, sampled[k], reference);
        compare(factors.row(sampled[k]), better.view(), columns,
                [&](std::uint32_t j, double difference, double should) {
                    squares[k] += difference * difference + rounding * should * rounding * should;
                    error += difference * sources[j];
                });
        if (factors.clusters() != nullptr) { // whose patches are not equally bright
            error += inside_clusters(reference.row(sampled[k]), better.view(), sources);
        }
        squares[k] /= share;
        area += counts;
        area_squares += counts * counts;
        mean += counts * error / share;
        measured += counts * error * error / share;
    }
    Variances variances = fit_variances(factors, sampled, squares, weights, areas);
    double modelled = 0.0;
    for (const std::uint32_t i : sampled) {
        modelled += areas[i] * variances.mean[i];
    }
    const double factor = modelled > 0.0 ? std::max(1.0, measured / modelled) : 0.0;
    double square = 0.0;
    double known = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        variances.mean[i] *= factor;
        variances.largest[i] *= factor;
        square += areas[i] * variances.mean[i];
        known += factors.known(i) ? areas[i] : 0.0;
    }
    variances.common = std::abs(mean) / area + std::sqrt(square / known * area_squares) / area;
    return variances;
}

/// Multiple-reflection gain: by how much the irradiance of all patches rises on the mean, by reflection among
/// them, where that of each is 1 higher from outside: sum A rho / sum A (1 - rho sum_j F), as of an enclosure
/// of one zone.
double multiple_reflection_gain(const FormFactorMatrix& factors, std::span<const double> areas,
                                std::span<const double> reflectance) {
    double lost = 0.0;
    double reflected = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (!factors.known(i)) {
            continue;
        }
        const double sum = factors.row(i).sum();
        lost += areas[i] * (1.0 - reflectance[i] * sum);
        reflected += areas[i] * reflectance[i];
    }
    return lost > 0.0 ? reflected / lost : 0.0;
}

} // namespace

FactorErrorEstimate estimate_factor_error(const FormFactorMatrix& factors, const FormFactorMatrix& reference,
                                          std::span<const std::uint32_t> columns) {
    const auto sampled = sampled_rows(factors, reference);
    const double share = share_of(factors, columns);
    std::vector<double> squares(sampled.size());
    std::vector<double> largest(sampled.size());
    std::uint64_t pairs = 0;
    for (std::size_t k = 0; k < sampled.size(); ++k) {
        const ComparableRow better(factors, sampled[k], reference);
        compare(factors.row(sampled[k]), better.view(), columns,
                [&](std::uint32_t, double error, double should) {
                    squares[k] += error * error + rounding * should * rounding * should;
                    largest[k] = std::max({largest[k], std::abs(error), rounding * should});
                    pairs += should > 0.0 ? 1 : 0;
                });
        squares[k] /= share;
    }
    const Variances variances = fit_variances(factors, sampled, squares, {}, {});
    FactorErrorEstimate estimate;
    estimate.sampled = static_cast<std::uint32_t>(sampled.size());
    double sum = 0.0;
    std::uint32_t known = 0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        sum += variances.mean[i];
        known += factors.known(i) ? 1 : 0;
        estimate.rows.push_back(std::sqrt(variances.largest[i]));
        estimate.row_max = std::max(estimate.row_max, estimate.rows.back());
    }
    const double pairs_a_row = static_cast<double>(pairs) / share / static_cast<double>(sampled.size());
    estimate.row_rms = std::sqrt(sum / std::max(1u, known));
    estimate.rms = estimate.row_rms / std::sqrt(std::max(1.0, pairs_a_row));
    estimate.max = largest_factor_error(factors, sampled, largest);
    return estimate;
}

RadiosityErrorEstimate
estimate_radiosity_error(const FormFactorMatrix& factors, const FormFactorMatrix& reference,
                         std::span<const double> areas, std::uint32_t channels,
                         std::span<const double> reflectance, std::span<const double> exitance,
                         std::span<const double> radiosity, std::span<const std::uint32_t> columns) {
    const std::uint32_t size = factors.size();
    const std::size_t values = std::size_t{size} * channels;
    if (areas.size() != size || reflectance.size() != values || exitance.size() != values ||
        radiosity.size() != values) {
        throw InvalidArgument(fmt::format("{} areas, {} reflectances, {} exitances and {} radiosities for {} "
                                          "patches of {} channels",
                                          areas.size(), reflectance.size(), exitance.size(), radiosity.size(),
                                          size, channels));
    }
    const auto all_sampled = sampled_rows(factors, reference);
    RadiosityErrorEstimate estimate;
    estimate.patches.resize(values);
    std::vector<double> rho(size);
    std::vector<double> b(size);
    for (std::uint32_t c = 0; c < channels; ++c) {
        for (std::uint32_t i = 0; i < size; ++i) {
            rho[i] = reflectance[std::size_t{i} * channels + c];
            b[i] = radiosity[std::size_t{i} * channels + c];
        }
        // Rows of what reflects nothing may see other light, and do not matter.
        std::vector<std::uint32_t> sampled;
        std::copy_if(all_sampled.begin(), all_sampled.end(), std::back_inserter(sampled),
                     [&](std::uint32_t i) { return rho[i] > 0.0; });
        if (sampled.empty()) {
            continue;
        }
        const Variances variances = irradiance_variances(factors, reference, columns, sampled, areas, b);
        const double common = variances.common * multiple_reflection_gain(factors, areas, rho);
        double errors = 0.0;
        double reflected = 0.0;
        double known_area = 0.0;
        double area = 0.0;
        for (std::uint32_t i = 0; i < size; ++i) {
            if (!(rho[i] > 0.0)) {
                continue;
            }
            const double part = b[i] - exitance[std::size_t{i} * channels + c];
            reflected += areas[i] * part * part;
            area += areas[i];
            if (!factors.known(i)) {
                continue;
            }
            known_area += areas[i];
            estimate.patches[std::size_t{i} * channels + c] =
                rho[i] * std::sqrt(variances.largest[i] + common * common);
            errors += areas[i] * rho[i] * rho[i] * (variances.mean[i] + common * common);
        }
        if (reflected > 0.0 && known_area > 0.0) {
            estimate.rms = std::max(estimate.rms, std::sqrt(errors * area / known_area / reflected));
        }
    }
    return estimate;
}

IrradianceErrors irradiance_errors(const FormFactorMatrix& factors, const FormFactorMatrix& reference,
                                   std::uint32_t channels, std::span<const double> radiosity,
                                   std::span<const double> environment) {
    if (radiosity.size() != std::size_t{factors.size()} * channels ||
        (!environment.empty() && environment.size() != channels)) {
        throw InvalidArgument(fmt::format("{} radiosities for {} patches of {} channels", radiosity.size(),
                                          factors.size(), channels));
    }
    IrradianceErrors result{sampled_rows(factors, reference), {}};
    result.errors.resize(result.rows.size() * channels);
    const std::vector<double> sources =
        with_clusters(factors, {radiosity.begin(), radiosity.end()}, channels);
    for (std::size_t k = 0; k < result.rows.size(); ++k) {
        const RowView row = factors.row(result.rows[k]);
        const RowView better = reference.row(result.rows[k]);
        for (std::uint32_t c = 0; c < channels && !environment.empty(); ++c) {
            result.errors[k * channels + c] = (row.environment - better.environment) * environment[c];
        }
        compare(row, better, {}, [&](std::uint32_t j, double difference, double /*should*/) {
            for (std::uint32_t c = 0; c < channels; ++c) {
                result.errors[k * channels + c] += difference * sources[std::size_t{j} * channels + c];
            }
        });
    }
    return result;
}

} // namespace hemi
