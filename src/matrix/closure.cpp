#include "matrix/closure.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

constexpr std::uint32_t block_rows = FormFactorMatrix::block_rows;

// A pair held at a bound has its value there, with the sign as the mark: the weight of what is not above 0
// is 0.
double magnitude(float value) {
    return std::abs(static_cast<double>(value));
}
double movable(float value) {
    return std::max(static_cast<double>(value), 0.0);
}

/// V of a code; the lowest code stands for half a step.
double visibility(std::uint8_t code) {
    return std::max<double>(code, 0.5) / visibility_clear;
}

} // namespace

Closure::Closure(std::vector<RowBlock>& blocks, std::span<const double> areas, bool with_visibility,
                 const RepairSettings& settings, const Progress& progress)
    : blocks_(blocks), areas_(areas), with_visibility_(with_visibility), settings_(settings),
      progress_(progress), cuts_(slice_rows(blocks)), rows_(blocks),
      pairs_(rows_, cuts_, static_cast<std::uint32_t>(areas.size()), PairEntries::right_of_diagonal, 1),
      gap_(areas.size(), 0.0), diagonal_(areas.size(), 0.0), multiplier_(areas.size(), 0.0) {
    for (std::uint32_t i = 0; i < gap_.size(); ++i) {
        const RowBlock& block = block_of(blocks, i);
        const std::uint64_t k = first_from(block, i % block_rows, i);
        if (k < block.begin[i % block_rows + 1] && block.columns[k] == i) {
            own_.push_back({i, k});
        }
    }
    for (const RowBlock& block : blocks) {
        all_known_ = all_known_ && std::find(block.known.begin(), block.known.end(), 0) == block.known.end();
    }
    const double rule = settings.unoccluded_error * settings.unoccluded_error;
    for (std::size_t code = 0; code < variance_.size(); ++code) {
        const double v = visibility(static_cast<std::uint8_t>(code));
        const double sampling = code == visibility_clear ? 0.0 : v * (1.0 - v);
        variance_[code] = with_visibility_ ? (sampling + rule) / (v * v) : 1.0;
    }
}

/// y = W z over pairs of known rows.
void Closure::multiply(const std::vector<double>& z, std::vector<double>& y) {
    const auto scale = [this](std::uint32_t i) { return areas_[i] * areas_[i]; };
    if (with_visibility_) {
        pairs_.apply(
            scale,
            [this](const RowView& row, std::uint32_t) {
                return [values = row.values.data(), codes = row.visibility.data(),
                        variance = variance_.data()](std::size_t k) {
                    const double value = movable(values[k]);
                    return value * value * variance[codes[k]];
                };
            },
            z.data(), y.data());
    } else {
        pairs_.apply(
            scale,
            [](const RowView& row, std::uint32_t) {
                return [values = row.values.data()](std::size_t k) {
                    const double value = movable(values[k]);
                    return value * value;
                };
            },
            z.data(), y.data());
    }
    for (const auto& [i, k] : own_) { // a pair with itself, whose sum moves by twice its multiplier
        const RowBlock& block = block_of(blocks_, i);
        const double x = areas_[i] * movable(block.values[k]);
        y[i] += x * x * variance_[with_visibility_ ? block.visibility[k] : 0] * z[i];
    }
}

void Closure::find_gaps() {
    const std::vector<double> ones(gap_.size(), 1.0);
    std::vector<double> sums(gap_.size());
    pairs_.apply([this](std::uint32_t i) { return areas_[i]; },
                 [](const RowView& row, std::uint32_t) {
                     return [values = row.values.data()](std::size_t k) { return magnitude(values[k]); };
                 },
                 ones.data(), sums.data());
    for (const auto& [i, k] : own_) {
        sums[i] += areas_[i] * magnitude(block_of(blocks_, i).values[k]);
    }
    for (std::uint32_t i = 0; i < gap_.size(); ++i) {
        const RowBlock& block = block_of(blocks_, i);
        const std::uint32_t local = i % block_rows;
        if (!all_known_) {
            visit_unknown_left(blocks_, i,
                               [&](std::uint64_t k) { sums[i] += areas_[i] * magnitude(block.values[k]); });
        }
        const double target = std::max(0.0, 1.0 - block.environment[local] - block.blocked[local]);
        gap_[i] = areas_[i] * target - sums[i];
    }
}

void Closure::find_diagonal() {
    multiply(std::vector<double>(gap_.size(), 1.0), diagonal_);
    for (std::uint32_t i = 0; i < gap_.size(); ++i) {
        const RowBlock& block = block_of(blocks_, i);
        if (!is_known(blocks_, i) || block.blocked[i % block_rows] > buried_above) {
            diagonal_[i] = 0.0;
        } else if (!all_known_) {
            visit_unknown_left(blocks_, i, [&](std::uint64_t k) {
                const double x = areas_[i] * movable(block.values[k]);
                diagonal_[i] += x * x * variance_[with_visibility_ ? block.visibility[k] : 0];
            });
        }
        if (diagonal_[i] == 0.0) {
            gap_[i] = 0.0;
            multiplier_[i] = 0.0;
        }
    }
}

/// Largest gap as an error of a row sum.
double Closure::relative_gap(const std::vector<double>& gap) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < gap.size(); ++i) {
        largest = std::max(largest, std::abs(gap[i]) / areas_[i]);
    }
    return largest;
}

/// (diag(W 1) + W) l = gap by conjugate gradients from the present multipliers, until no row misses its
/// target by more than `tolerance`.
/// @return iterations
std::uint32_t Closure::find_multipliers(double tolerance) {
    // Where targets contradict each other the residual ends at what contradicts; the best is kept, and the
    // end is taken to be reached when so many iterations have not lowered it to this share: twice as many as
    // a room takes to 1e-12 where targets agree.
    constexpr std::uint32_t max_stalled_iterations = 60;
    constexpr double min_progress = 0.9;
    // Curvature along a direction, relative to that of the diagonal alone, below which it may be rounding:
    // some hundred units in the last place of a double.
    constexpr double rounding_curvature = 1e-13;
    const std::size_t size = gap_.size();
    std::vector<double> residual = gap_;
    std::vector<double> product(size);
    const auto apply = [&](const std::vector<double>& z) {
        multiply(z, product);
        for (std::size_t i = 0; i < size; ++i) {
            product[i] = diagonal_[i] > 0.0 ? product[i] + diagonal_[i] * z[i] : 0.0;
        }
    };
    apply(multiplier_);
    for (std::size_t i = 0; i < size; ++i) {
        residual[i] -= product[i];
    }
    std::vector<double> l = multiplier_;
    std::vector<double> direction(size, 0.0);
    double best = relative_gap(residual);
    double mark = best;
    double rho_before = 0.0;
    std::uint32_t iteration = 0;
    std::uint32_t since = 0;
    while (best > tolerance && iteration < settings_.max_iterations && since < max_stalled_iterations) {
        double rho = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
            rho += diagonal_[i] > 0.0 ? residual[i] * residual[i] / diagonal_[i] : 0.0;
        }
        const double beta = iteration == 0 ? 0.0 : rho / rho_before;
        rho_before = rho;
        for (std::size_t i = 0; i < size; ++i) {
            direction[i] = diagonal_[i] > 0.0 ? residual[i] / diagonal_[i] + beta * direction[i] : 0.0;
        }
        apply(direction);
        double curvature = 0.0;
        double scale = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
            curvature += direction[i] * product[i];
            scale += diagonal_[i] * direction[i] * direction[i];
        }
        ++iteration;
        const double alpha = rho / curvature;
        // What is left along a direction that changes no sum contradicts itself: no step along it helps.
        if (!(curvature > rounding_curvature * scale) || !std::isfinite(alpha)) {
            break;
        }
        for (std::size_t i = 0; i < size; ++i) {
            l[i] += alpha * direction[i];
            residual[i] -= alpha * product[i];
        }
        const double gap = relative_gap(residual);
        if (gap < best) {
            best = gap;
            multiplier_ = l;
        }
        tell(best);
        ++since;
        if (best < min_progress * mark) {
            mark = best;
            since = 0;
        }
    }
    return iteration;
}

void Closure::tell(double gap) {
    if (!progress_) {
        return;
    }
    // Conjugate gradients make gaps smaller by about the same share in every step.
    first_gap_ = std::max(first_gap_, gap);
    const double whole = std::log(first_gap_ / settings_.tolerance);
    const double done = whole > 0.0 && gap > 0.0 ? std::log(first_gap_ / gap) / whole : 1.0;
    told_ = std::max(told_, static_cast<std::size_t>(100.0 * std::clamp(done, 0.0, 0.99)));
    if (!progress_(told_, 100)) {
        throw Cancelled();
    }
}

/// x of an entry with its multipliers; of a held one its bound.
double Closure::exchange(std::uint32_t i, const RowBlock& block, std::uint64_t k, double multipliers) const {
    const double x = areas_[i] * movable(block.values[k]);
    const double weight = x * x * variance_[with_visibility_ ? block.visibility[k] : 0];
    return areas_[i] * magnitude(block.values[k]) + weight * multipliers;
}

/// The largest x of an entry that is not held.
double Closure::limit(std::uint32_t i, const RowBlock& block, std::uint64_t k) const {
    if (!with_visibility_ || block.visibility[k] == visibility_clear) {
        return std::numeric_limits<double>::infinity();
    }
    return areas_[i] * movable(block.values[k]) / visibility(block.visibility[k]) *
           (1.0 + settings_.unoccluded_error);
}

/// Calls `visit(first, last, tally)` for every slice of rows, in threads.
template <class Visit>
void Closure::for_slices(const Visit& visit) {
    parallel_for(cuts_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            visit(s, cuts_[s], cuts_[s + 1]);
        }
    });
}

Closure::Tally Closure::hold_at_bounds() {
    std::vector<Tally> tallies(cuts_.size() - 1);
    for_slices([&](std::size_t s, std::uint32_t first, std::uint32_t last) {
        Tally tally;
        for (std::uint32_t i = first; i < last; ++i) {
            RowBlock& block = blocks_[i / block_rows];
            const auto hold = [&](std::uint64_t k) {
                float& value = block.values[k];
                if (!(value > 0.0F)) {
                    return;
                }
                const double x = exchange(i, block, k, multiplier_[i] + multiplier_[block.columns[k]]);
                const double most = limit(i, block, k);
                if (x < 0.0) {
                    value = 0.0F;
                    ++tally.at_zero;
                    tally.largest_change = std::max(tally.largest_change, 1.0);
                } else if (x > most) {
                    tally.largest_change =
                        std::max(tally.largest_change, most / (areas_[i] * movable(value)) - 1.0);
                    value = -static_cast<float>(most / areas_[i]);
                    ++tally.at_unoccluded;
                }
            };
            for (std::uint64_t k = first_from(block, i % block_rows, i); k < block.begin[i % block_rows + 1];
                 ++k) {
                hold(k);
            }
            if (!all_known_) {
                visit_unknown_left(blocks_, i, hold);
            }
        }
        tallies[s] = tally;
    });
    Tally all;
    for (const Tally& tally : tallies) {
        all.at_zero += tally.at_zero;
        all.at_unoccluded += tally.at_unoccluded;
        all.largest_change = std::max(all.largest_change, tally.largest_change);
    }
    return all;
}

/// The values as the multipliers make them, both directions from one.
Closure::Tally Closure::write() {
    std::vector<double> largest(cuts_.size() - 1, 0.0);
    for_slices([&](std::size_t s, std::uint32_t first, std::uint32_t last) {
        double change = 0.0;
        const auto write_entry = [&](std::uint32_t i, RowBlock& block, std::uint64_t k) {
            float& value = block.values[k];
            const double before = areas_[i] * magnitude(value);
            const double x = exchange(i, block, k, multiplier_[i] + multiplier_[block.columns[k]]);
            if (before > 0.0) {
                change = std::max(change, std::abs(x - before) / before);
            }
            value = static_cast<float>(std::max(x, 0.0) / areas_[i]);
        };
        visit_pairs(std::span<const RowBlock>(blocks_), first, last,
                    [&](std::uint32_t i, std::uint64_t k_ij, std::uint32_t j, std::uint64_t k_ji) {
                        RowBlock& block = blocks_[i / block_rows];
                        write_entry(i, block, k_ij);
                        blocks_[j / block_rows].values[k_ji] = static_cast<float>(
                            areas_[i] * static_cast<double>(block.values[k_ij]) / areas_[j]);
                    });
        for (auto own = std::lower_bound(own_.begin(), own_.end(), first,
                                         [](const Own&one, std::uint32_t row) { return one.row < row; });
             own != own_.end() && own->row < last; ++own) {
            write_entry(own->row, blocks_[own->row / block_rows], own->entry);
        }
        for (std::uint32_t i = first; i < last && !all_known_; ++i) {
            RowBlock& block = blocks_[i / block_rows];
            for (std::uint64_t k = block.begin[i % block_rows]; k < block.begin[i % block_rows + 1]; ++k) {
                if (!is_known(blocks_, block.columns[k])) {
                    write_entry(i, block, k);
                }
            }
        }
        largest[s] = change;
    });
    return {.largest_change = *std::max_element(largest.begin(), largest.end())};
}

void Closure::run(RepairReport& report) {
    // Which pairs go beyond their bounds shows long before the multipliers are exact: the passes before the
    // last close gaps to this share of what they were.
    constexpr double rough_share = 0.01;
    bool exact = false;
    for (bool settled = false; !settled;) {
        find_gaps();
        find_diagonal();
        const bool last = ++report.passes >= settings_.max_passes;
        exact = exact || last;
        const double rough = rough_share * relative_gap(gap_);
        report.iterations +=
            find_multipliers(exact ? settings_.tolerance : std::max(settings_.tolerance, rough));
        // After the last pass pairs are put at their bounds without a new solution for the others.
        const Tally held = hold_at_bounds();
        report.at_zero += held.at_zero;
        report.at_unoccluded += held.at_unoccluded;
        report.largest_change = std::max(report.largest_change, held.largest_change);
        const bool none = held.at_zero == 0 && held.at_unoccluded == 0;
        settled = last || (none && exact);
        exact = exact || none;
    }
    report.largest_change = std::max(report.largest_change, write().largest_change);
    if (progress_ && !progress_(100, 100)) {
        throw Cancelled();
    }
}

} // namespace hemi
