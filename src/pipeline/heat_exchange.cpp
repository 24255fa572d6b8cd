#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/heat.hpp"
#include "pipeline/heat_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace hemi {

namespace {

double divisor(double area) {
    return area > 0.0 ? area : 1.0;
}

/// Script-F and Gebhart factors by the conductances.
void find_shares(HeatExchange& exchange) {
    const std::size_t groups = exchange.areas.size();
    exchange.script_f.assign(groups * groups, 0.0);
    exchange.gebhart.assign(groups * groups, 0.0);
    for (std::size_t g = 0; g < groups; ++g) {
        for (std::size_t k = g * groups; k < (g + 1) * groups; ++k) {
            exchange.script_f[k] = exchange.conductance[k] / divisor(exchange.areas[g]);
            if (exchange.emissivity[g] > 0.0) {
                exchange.gebhart[k] = exchange.script_f[k] / exchange.emissivity[g];
            }
        }
    }
}

class Exchange {
public:
    Exchange(const FormFactors& factors, const HeatProblem& problem)
        : factors_(factors), problem_(problem), network_(make_network(factors, problem)),
          groups_(static_cast<std::uint32_t>(factors.groups.size())), unit_(problem.unit * problem.unit) {
        result_.areas.assign(groups_, 0.0);
        result_.emissivity.assign(groups_, 0.0);
        result_.conductance.assign(std::size_t{groups_} * groups_, 0.0);
        result_.environment.assign(groups_, 0.0);
        result_.asymmetry = network_.asymmetry();
        for (std::uint32_t i = 0; i < network_.size(); ++i) {
            const double area = factors.areas[i] * unit_;
            result_.areas[factors.group_of[i]] += area;
            result_.emissivity[factors.group_of[i]] += area * problem.emissivity[i];
        }
    }

    HeatExchange find(const HeatSettings& settings, Observer& observer) {
        const std::uint32_t at_once = columns_at_once(factors_.matrix);
        for (std::uint32_t first = 0; first < groups_; first += at_once) {
            add_columns(first, std::min(at_once, groups_ - first), settings, observer);
        }
        finish();
        return std::move(result_);
    }

private:
    /// The patches of one group a column radiate as black bodies of 1 W/m² would, times their emissivity.
    void add_columns(std::uint32_t first, std::uint32_t columns, const HeatSettings& settings,
                     Observer& observer) {
        NetworkSources sources;
        sources.columns = columns;
        sources.environment.assign(columns, 0.0);
        for (std::uint32_t i = 0; i < network_.size(); ++i) {
            const double eps = problem_.emissivity[i];
            for (std::uint32_t c = 0; c < columns; ++c) {
                sources.emissivity.push_back(eps);
                sources.source.push_back(factors_.group_of[i] == first + c ? eps : 0.0);
            }
        }
        const NetworkFluxes fluxes =
            network_.solve(sources, settings.tolerance, heat_progress(observer, settings.tolerance));
        for (std::uint32_t i = 0; i < network_.size(); ++i) {
            const std::uint32_t g = factors_.group_of[i];
            const double area = factors_.areas[i] * unit_;
            for (std::uint32_t c = 0; c < columns; ++c) {
                const std::size_t at = std::size_t{i} * columns + c;
                result_.conductance[std::size_t{g} * groups_ + first + c] +=
                    area * problem_.emissivity[i] * fluxes.irradiation[at];
                result_.environment[first + c] += area * network_.environment()[i] * fluxes.radiosity[at];
            }
        }
    }

    void finish() {
        constexpr double rounding = 1e-13; // of what a group radiates, as yet the sum over its patches
        const auto at = [this](std::uint32_t g, std::uint32_t h) { return std::size_t{g} * groups_ + h; };
        for (std::uint32_t g = 0; g < groups_; ++g) {
            for (std::uint32_t h = 0; h < g; ++h) {
                const double mean = 0.5 * (result_.conductance[at(g, h)] + result_.conductance[at(h, g)]);
                // Groups that do not see each other have none but what rounding leaves.
                const double least = rounding * std::min(result_.emissivity[g], result_.emissivity[h]);
                result_.conductance[at(g, h)] = result_.conductance[at(h, g)] = mean > least ? mean : 0.0;
            }
        }
        for (std::uint32_t g = 0; g < groups_; ++g) {
            const double area = divisor(result_.areas[g]);
            result_.emissivity[g] /= area;
            result_.environment[g] /= area;
        }
        find_shares(result_);
    }

    const FormFactors& factors_;
    const HeatProblem& problem_;
    ExchangeNetwork network_;
    std::uint32_t groups_;
    double unit_;
    HeatExchange result_;
};

/// The network of groups, and of the environment as its last node, of which small conductances are left out.
class Cutoff {
public:
    Cutoff(const HeatExchange& exchange, double min)
        : size_(exchange.areas.size() + 1), full_(size_ * size_, 0.0), kept_(size_ * size_, 0),
          sums_(size_, 0.0), dropped_(size_, 0.0), potential_(size_, 0.0) {
        const std::size_t groups = size_ - 1;
        for (std::size_t g = 0; g < groups; ++g) {
            for (std::size_t h = 0; h < groups; ++h) {
                full_[at(g, h)] = exchange.conductance[g * groups + h];
            }
            full_[at(g, groups)] = full_[at(groups, g)] = exchange.environment[g] * exchange.areas[g];
        }
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t j = 0; j < size_; ++j) {
                sums_[i] += full_[at(i, j)];
                kept_[at(i, j)] = full_[at(i, j)] > 0.0 ? 1 : 0;
            }
        }
        report_.min = min;
    }

    ExchangeCutoff run() {
        network_ = full_;
        while (drop()) {
            scale();
        }
        finish_report();
        return report_;
    }

    [[nodiscard]] const std::vector<double>& network() const { return network_; }
    [[nodiscard]] std::size_t at(std::size_t i, std::size_t j) const { return i * size_ + j; }

private:
    /// @return whether there was anything to leave out
    bool drop() {
        bool any = false;
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (kept_[at(i, j)] != 0 && network_[at(i, j)] < report_.min) {
                    kept_[at(i, j)] = kept_[at(j, i)] = 0;
                    dropped_[i] += full_[at(i, j)];
                    dropped_[j] += full_[at(i, j)];
                    ++report_.dropped;
                    any = true;
                }
            }
        }
        return any;
    }

    [[nodiscard]] double kept(std::size_t i, std::size_t j) const {
        if (i != j) {
            return kept_[at(i, j)] != 0 ? full_[at(i, j)] : 0.0;
        }
        return full_[at(i, i)] + (sums_[i] > 0.0 ? dropped_[i] * (dropped_[i] / sums_[i]) : 0.0);
    }

    /// D = exp(potential), which makes sum K' / 2 - sums·potential least: a convex function, whose Newton
    /// steps go downhill where they change no conductance by more than a factor e.
    void scale() {
        constexpr double tolerance = 1e-13; // of a row's sum
        constexpr double enough = 1e-10;    // where rounding allows no better
        constexpr int max_steps = 300;
        std::vector<double> gap(size_);
        double last = std::numeric_limits<double>::infinity();
        for (int step = 0; step < max_steps; ++step) {
            const double worst = apply(gap);
            if (worst <= tolerance || (worst <= enough && worst >= last)) {
                return;
            }
            last = worst;
            solve(gap);
            double largest = 0.0;
            for (const double change : gap) {
                largest = std::max(largest, std::abs(change));
            }
            const double share = largest > 0.5 ? 0.5 / largest : 1.0;
            for (std::size_t i = 0; i < size_; ++i) {
                potential_[i] += share * gap[i];
            }
        }
        throw NotConverged(fmt::format("the conductances that are left without those below {} m² do not "
                                       "balance: rows miss their sums by up to {:.2g}",
                                       report_.min, last));
    }

    /// The network by the potentials. @return the largest gap over the sum that it is of
    double apply(std::vector<double>& gap) {
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
                network_[at(i, j)] = network_[at(j, i)] =
                    kept(i, j) * std::exp(potential_[i] + potential_[j]);
            }
        }
        double worst = 0.0;
        for (std::size_t i = 0; i < size_; ++i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < size_; ++j) {
                sum += network_[at(i, j)];
            }
            gap[i] = sums_[i] - sum;
            worst = sums_[i] > 0.0 ? std::max(worst, std::abs(gap[i]) / sums_[i]) : worst;
        }
        return worst;
    }

    /// (diag(sums of K') + K') x = gap, in place, by Cholesky's factors. Nodes that the others' equations
    /// leave nothing to, as one of two black plates, stay.
    void solve(std::vector<double>& x) const {
        constexpr double nothing = 1e-14; // of a diagonal element
        std::vector<double> factor = network_;
        for (std::size_t i = 0; i < size_; ++i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < size_; ++j) {
                sum += network_[at(i, j)];
            }
            factor[at(i, i)] += sum;
        }
        std::vector<std::uint8_t> is_left(size_, 0);
        for (std::size_t i = 0; i < size_; ++i) {
            const double diagonal = factor[at(i, i)];
            for (std::size_t j = 0; j <= i; ++j) {
                double value = factor[at(i, j)];
                for (std::size_t k = 0; k < j; ++k) {
                    value -= factor[at(i, k)] * factor[at(j, k)];
                }
                if (i != j) {
                    factor[at(i, j)] = is_left[j] != 0 ? 0.0 : value / factor[at(j, j)];
                } else if (value > nothing * diagonal) {
                    factor[at(i, i)] = std::sqrt(value);
                } else {
                    is_left[i] = 1;
                }
            }
        }
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                x[i] -= factor[at(i, k)] * x[k];
            }
            x[i] = is_left[i] != 0 ? 0.0 : x[i] / factor[at(i, i)];
        }
        for (std::size_t i = size_; i-- > 0;) {
            for (std::size_t k = i + 1; k < size_; ++k) {
                x[i] -= factor[at(k, i)] * x[k];
            }
            x[i] = is_left[i] != 0 ? 0.0 : x[i] / factor[at(i, i)];
        }
    }

    void finish_report() {
        for (std::size_t i = 0; i < size_; ++i) {
            bool had_others = false;
            bool has_others = false;
            for (std::size_t j = 0; j < size_; ++j) {
                if (i == j) {
                    continue;
                }
                had_others = had_others || full_[at(i, j)] > 0.0;
                if (kept_[at(i, j)] != 0) {
                    has_others = true;
                    report_.kept += j < i ? 1 : 0;
                    report_.largest_change = std::max(report_.largest_change,
                                                      std::abs(network_[at(i, j)] / full_[at(i, j)] - 1.0));
                }
            }
            if (i + 1 < size_ && had_others && !has_others) {
                report_.isolated.push_back(static_cast<std::uint32_t>(i));
            }
            if (i + 1 < size_ && sums_[i] > 0.0) {
                report_.largest_share = std::max(report_.largest_share, dropped_[i] / sums_[i]);
            }
        }
    }

    std::size_t size_;
    std::vector<double> full_;       // conductances as they were, size_ by size_
    std::vector<std::uint8_t> kept_; // which are kept
    std::vector<double> sums_;       // of rows of full_
    std::vector<double> dropped_;    // of them, what is not kept
    std::vector<double> potential_;  // logarithm of D
    std::vector<double> network_;    // conductances as they become
    ExchangeCutoff report_;
};

} // namespace

ExchangeCutoff drop_small_conductances(HeatExchange& exchange, double min) {
    if (!(min > 0.0 && std::isfinite(min))) {
        throw InvalidArgument(fmt::format("a least conductance of {} m²; must be above 0", min));
    }
    Cutoff cutoff(exchange, min);
    ExchangeCutoff report = cutoff.run();
    if (report.dropped == 0) {
        return report;
    }
    const std::size_t groups = exchange.areas.size();
    for (std::size_t g = 0; g < groups; ++g) {
        for (std::size_t h = 0; h < groups; ++h) {
            exchange.conductance[g * groups + h] = cutoff.network()[cutoff.at(g, h)];
        }
        exchange.environment[g] = cutoff.network()[cutoff.at(g, groups)] / divisor(exchange.areas[g]);
    }
    find_shares(exchange);
    return report;
}

HeatExchange heat_exchange(const FormFactors& factors, const HeatProblem& problem,
                           const HeatSettings& settings, Observer& observer) {
    if (problem.bands != 1) {
        throw InputError(fmt::format("exchange factors are grey, and the scene has {}",
                                     plural(problem.bands, "wavelength band", "wavelength bands")));
    }
    const auto by_temperature = std::find_if(problem.table_of.begin(), problem.table_of.end(),
                                             [](std::uint32_t table) { return table != no_heat; });
    if (by_temperature != problem.table_of.end()) {
        const std::uint32_t i = static_cast<std::uint32_t>(by_temperature - problem.table_of.begin());
        throw InputError(fmt::format("exchange factors know no temperatures, and the emissivity of group {} "
                                     "depends on it; give one value, as --emissivity '{}=0.7'",
                                     factors.groups[factors.group_of[i]],
                                     factors.groups[factors.group_of[i]]));
    }
    return Exchange(factors, problem).find(settings, observer);
}

} // namespace hemi
