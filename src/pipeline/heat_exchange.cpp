#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/heat.hpp"
#include "pipeline/heat_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

namespace {

/// Groups whose columns are solved side by side: every product reads the rows once for all of them.
constexpr std::uint32_t columns_at_once = 16;

class Exchange {
public:
    Exchange(const FormFactors& factors, const HeatProblem& problem)
        : factors_(factors), problem_(problem), network_(make_network(factors, problem)),
          groups_(static_cast<std::uint32_t>(factors.groups.size())), unit_(problem.unit * problem.unit) {
        result_.areas.assign(groups_, 0.0);
        result_.emissivity.assign(groups_, 0.0);
        result_.conductance.assign(std::size_t{groups_} * groups_, 0.0);
        result_.environment.assign(groups_, 0.0);
        for (std::uint32_t i = 0; i < network_.size(); ++i) {
            const double area = factors.areas[i] * unit_;
            result_.areas[factors.group_of[i]] += area;
            result_.emissivity[factors.group_of[i]] += area * problem.emissivity[i];
        }
    }

    HeatExchange find(const HeatSettings& settings, Observer& observer) {
        for (std::uint32_t first = 0; first < groups_; first += columns_at_once) {
            add_columns(first, std::min(columns_at_once, groups_ - first), settings, observer);
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
        const auto at = [this](std::uint32_t g, std::uint32_t h) { return std::size_t{g} * groups_ + h; };
        for (std::uint32_t g = 0; g < groups_; ++g) {
            for (std::uint32_t h = 0; h < g; ++h) {
                const double mean = 0.5 * (result_.conductance[at(g, h)] + result_.conductance[at(h, g)]);
                result_.conductance[at(g, h)] = result_.conductance[at(h, g)] = mean;
            }
        }
        for (std::uint32_t g = 0; g < groups_; ++g) {
            const double area = result_.areas[g] > 0.0 ? result_.areas[g] : 1.0;
            result_.emissivity[g] /= area;
            result_.environment[g] /= area;
            for (std::uint32_t h = 0; h < groups_; ++h) {
                const double script_f = result_.conductance[at(g, h)] / area;
                result_.script_f.push_back(script_f);
                result_.gebhart.push_back(result_.emissivity[g] > 0.0 ? script_f / result_.emissivity[g]
                                                                      : 0.0);
            }
        }
    }

    const FormFactors& factors_;
    const HeatProblem& problem_;
    ExchangeNetwork network_;
    std::uint32_t groups_;
    double unit_;
    HeatExchange result_;
};

} // namespace

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
                                     "depends on it; give one value",
                                     factors.groups[factors.group_of[i]]));
    }
    return Exchange(factors, problem).find(settings, observer);
}

} // namespace hemi
