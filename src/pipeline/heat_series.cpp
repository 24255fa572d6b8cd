#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/pipeline/heat.hpp"
#include "pipeline/heat_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace hemi {

namespace {

/// Column that is the environment's.
constexpr std::uint32_t of_environment = no_heat;

constexpr const char* environment_name = "environment";

HeatQuantity given(const HeatCondition& condition) {
    return condition.temperature ? HeatQuantity::temperature
           : condition.power     ? HeatQuantity::power
                                 : HeatQuantity::heat_flux;
}

/// The condition that a column changes: one for all of its group, in place of several of one kind, or of
/// none.
std::uint32_t condition_of(const std::vector<std::string>& groups, std::span<const std::uint32_t> group_of,
                           HeatProblem& problem, const std::string& name) {
    const auto found = std::find(groups.begin(), groups.end(), name);
    if (found == groups.end()) {
        if (name == environment_name) {
            return of_environment;
        }
        std::vector<std::string> known = groups;
        known.emplace_back(environment_name);
        throw InputError(fmt::format("no group \"{}\"{}", name, did_you_mean_or_list(name, known)));
    }
    const auto group = static_cast<std::uint32_t>(found - groups.begin());
    std::set<std::uint32_t> own;
    std::set<std::uint32_t> others;
    for (std::size_t i = 0; i < group_of.size(); ++i) {
        (group_of[i] == group ? own : others).insert(problem.condition_of[i]);
    }
    const auto refuse = [&name](const char* has) {
        throw InputError(fmt::format("group \"{}\" has {}; the column needs one kind of condition for all "
                                     "of it and nothing else: temperature, heat flux or power",
                                     name, has));
    };
    if (own.size() > 1 && own.contains(no_heat)) {
        refuse("parts without temperature, heat flux and power");
    }
    HeatCondition condition;
    condition.temperature = 0.0; // of each line its own
    bool shared = false;
    if (!own.empty() && !own.contains(no_heat)) {
        condition = problem.conditions[*own.begin()];
        for (const std::uint32_t c : own) {
            const HeatCondition& other = problem.conditions[c];
            shared = shared || others.contains(c);
            if (given(other) != given(condition)) {
                refuse("conditions of several kinds");
            }
            if (other.isothermal && (own.size() > 1 || others.contains(c))) {
                refuse("an isothermal part, or is isothermal together with others");
            }
        }
        if (shared && given(condition) == HeatQuantity::power) {
            refuse("a power together with others");
        }
        if (own.size() == 1 && !shared) {
            return *own.begin();
        }
    }
    const auto index = static_cast<std::uint32_t>(problem.conditions.size());
    problem.conditions.push_back(condition);
    for (std::size_t i = 0; i < group_of.size(); ++i) {
        if (group_of[i] == group) {
            problem.condition_of[i] = index;
        }
    }
    return index;
}

/// A line, from 1, for messages.
std::string line_text(const HeatSchedule& schedule, std::size_t line) {
    const std::size_t place = line < schedule.places.size() ? schedule.places[line] : line + 1;
    return line < schedule.labels.size() ? fmt::format("line {} (\"{}\")", place, schedule.labels[line])
                                         : fmt::format("line {}", place);
}

/// The conditions that the columns change, in the problem.
std::vector<std::uint32_t> conditions_of(const std::vector<std::string>& groups,
                                         std::span<const std::uint32_t> group_of, HeatProblem& problem,
                                         const HeatSchedule& schedule) {
    const std::size_t columns = schedule.columns.size();
    if (columns == 0 || schedule.values.size() % columns != 0) {
        throw InvalidArgument(
            fmt::format("a schedule of {} columns and {} values", columns, schedule.values.size()));
    }
    std::vector<std::uint32_t> conditions;
    for (const std::string& name : schedule.columns) {
        conditions.push_back(condition_of(groups, group_of, problem, name));
        if (std::count(schedule.columns.begin(), schedule.columns.end(), name) > 1) {
            throw InputError(fmt::format("two columns \"{}\"", name));
        }
    }
    for (std::size_t k = 0; k < schedule.values.size(); ++k) {
        const std::uint32_t c = conditions[k % columns];
        if ((c == of_environment || problem.conditions[c].temperature) && !(schedule.values[k] >= 0.0)) {
            throw InputError(fmt::format("{}, {}: {} K; must not be below 0 K",
                                         line_text(schedule, k / columns), schedule.columns[k % columns],
                                         schedule.values[k]));
        }
    }
    return conditions;
}

/// Columns of temperatures that are those of a room in °C throughout, while others are hot.
void warn_of_celsius(const HeatProblem& problem, const HeatSchedule& schedule,
                     std::span<const HeatQuantity> quantities, Observer& observer) {
    constexpr double cold = 150.0;
    constexpr double warm = 250.0;
    double hottest = problem.environment_temperature.value_or(0.0);
    for (const HeatCondition& condition : problem.conditions) {
        hottest = std::max(hottest, condition.temperature.value_or(0.0));
    }
    std::vector<double> most(quantities.size(), 0.0);
    for (std::size_t k = 0; k < schedule.values.size(); ++k) {
        double& of_column = most[k % quantities.size()];
        of_column = std::max(of_column, schedule.values[k]);
    }
    for (std::size_t c = 0; c < quantities.size(); ++c) {
        hottest = quantities[c] == HeatQuantity::temperature ? std::max(hottest, most[c]) : hottest;
    }
    for (std::size_t c = 0; c < quantities.size() && hottest > warm; ++c) {
        const bool sky = schedule.columns[c] == environment_name; // space has 2.7 K
        if (quantities[c] == HeatQuantity::temperature && most[c] < cold && most[c] > (sky ? 5.0 : 0.0)) {
            observer.warning(fmt::format("column {} has {} K at most, while others have up to {} K; if °C is "
                                         "meant, write \"{} C\"",
                                         schedule.columns[c], most[c], hottest, most[c]),
                             "temperature");
        }
    }
}

class Series {
public:
    Series(const FormFactors& factors, const HeatProblem& problem, const HeatSchedule& schedule,
           const HeatSettings& settings, Observer& observer)
        : factors_(factors), problem_(problem), schedule_(schedule), settings_(settings), observer_(observer),
          columns_(schedule.columns.size()), groups_(factors.groups.size()) {
        condition_ = conditions_of(factors.groups, factors.group_of, problem_, schedule);
        lines_ = schedule.values.size() / columns_;
        series_.groups = static_cast<std::uint32_t>(groups_);
    }

    HeatSeries solve() {
        series_.superposed = is_linear();
        if (series_.superposed) {
            superpose();
        } else {
            solve_lines();
        }
        return std::move(series_);
    }

private:
    [[nodiscard]] double value(std::size_t l, std::size_t c) const {
        return schedule_.values[l * columns_ + c];
    }
    [[nodiscard]] bool is_temperature(std::size_t c) const {
        return condition_[c] == of_environment || problem_.conditions[condition_[c]].temperature;
    }

    /// Whether the field of several lines is the sum of their fields.
    [[nodiscard]] bool is_linear() const {
        bool fluxes = false;
        for (const std::uint32_t c : problem_.condition_of) {
            const bool given = c == no_heat || problem_.conditions[c].temperature;
            fluxes = fluxes || !given;
            if (!given && problem_.conditions[c].isothermal) {
                return false;
            }
        }
        const bool tables = std::any_of(problem_.table_of.begin(), problem_.table_of.end(),
                                        [](std::uint32_t table) { return table != no_heat; });
        return !tables && (problem_.bands == 1 || !fluxes);
    }

    /// The problem with the values of a line.
    [[nodiscard]] HeatProblem at_line(std::size_t l) const {
        HeatProblem problem = problem_;
        for (std::size_t c = 0; c < columns_; ++c) {
            if (condition_[c] == of_environment) {
                problem.environment_temperature = value(l, c);
                continue;
            }
            HeatCondition& condition = problem.conditions[condition_[c]];
            (condition.temperature ? condition.temperature
             : condition.power     ? condition.power
                                   : condition.heat_flux) = value(l, c);
        }
        return problem;
    }

    /// Says of which line an error is.
    template <class Work>
    void with_line(std::size_t l, const Work& work) const {
        const auto text = [&](const Error& error) {
            return fmt::format("{}: {}", line_text(schedule_, l), error.what());
        };
        try {
            work();
        } catch (const InputError& error) {
            throw InputError(text(error), error.settings());
        } catch (const NotConverged& error) {
            throw NotConverged(text(error), error.settings());
        }
    }

    void solve_lines() {
        const ExchangeNetwork network = make_network(factors_, problem_);
        for (std::size_t l = 0; l < lines_; ++l) {
            const HeatProblem problem = at_line(l);
            HeatSolution solution;
            with_line(
                l, [&] { solution = solve_heat_network(network, factors_, problem, settings_, observer_); });
            const std::vector<GroupHeat> all = group_heat(factors_, problem, solution);
            for (std::size_t g = 0; g < groups_; ++g) {
                series_.temperature.push_back(all[g].temperature);
                series_.net_flux.push_back(all[g].net_flux);
                series_.net_power.push_back(all[g].net_power);
            }
            series_.environment_power.push_back(solution.environment_power);
        }
    }

    /// What comes of a source of 1 W/m², summed over the area of every group.
    struct Response {
        std::vector<double> net;      // W, a group
        std::vector<double> arriving; // irradiation of every patch whose temperature follows it, W/m²
        double environment = 0.0;     // W, leaving the environment
    };

    /// One column a source and band; the last one of a band is everything that the schedule leaves alone.
    void find_responses(const ExchangeNetwork& network, const std::vector<std::uint8_t>& buried) {
        const auto sources = static_cast<std::uint32_t>(columns_) + 1;
        const std::uint32_t at_once = columns_at_once(factors_.matrix);
        responses_.assign(std::size_t{problem_.bands} * sources, {});
        for (std::uint32_t k = 0; k < problem_.bands; ++k) {
            for (std::uint32_t first = 0; first < sources; first += at_once) {
                add_responses(network, buried, k, first, std::min(at_once, sources - first));
            }
        }
    }

    /// Those of some columns of a band.
    void add_responses(const ExchangeNetwork& network, const std::vector<std::uint8_t>& buried,
                       std::uint32_t band, std::uint32_t first, std::uint32_t count) {
        NetworkSources columns = sources_of(network.size(), buried, band, first, count);
        const NetworkFluxes fluxes =
            network.solve(columns, settings_.tolerance, heat_progress(observer_, settings_.tolerance));
        for (std::uint32_t s = 0; s < count; ++s) {
            Response& response = responses_[std::size_t{band} * (columns_ + 1) + first + s];
            response.net.assign(groups_, 0.0);
            for (std::uint32_t i = 0; i < network.size(); ++i) {
                const std::size_t at = std::size_t{i} * count + s;
                const double area = factors_.areas[i] * problem_.unit * problem_.unit;
                if (buried[i] == 0) {
                    const double direct = columns.direct.empty() ? 0.0 : columns.direct[at];
                    response.environment +=
                        area *
                        (network.environment()[i] * (columns.environment[s] - fluxes.radiosity[at]) + direct);
                    response.net[factors_.group_of[i]] +=
                        area * (columns.source[at] - columns.emissivity[at] * fluxes.irradiation[at]);
                }
            }
            for (const std::uint32_t i : followers_) {
                response.arriving.push_back(fluxes.irradiation[std::size_t{i} * count + s]);
            }
        }
    }

    [[nodiscard]] NetworkSources sources_of(std::uint32_t patches, const std::vector<std::uint8_t>& buried,
                                            std::uint32_t band, std::uint32_t first,
                                            std::uint32_t count) const {
        const std::vector<double> fixed_fluxes = condition_fluxes(factors_, problem_, buried);
        NetworkSources columns;
        columns.columns = count;
        for (std::uint32_t s = first; s < first + count; ++s) {
            columns.environment.push_back(s == columns_                     ? environment_beside(band)
                                          : condition_[s] == of_environment ? 1.0
                                                                            : 0.0);
        }
        const bool rest = first + count > columns_;
        if (rest && !problem_.direct.empty()) {
            columns.direct.assign(std::size_t{patches} * count, 0.0);
            for (std::uint32_t i = 0; i < patches; ++i) {
                columns.direct[(std::size_t{i} + 1) * count - 1] =
                    problem_.direct[std::size_t{i} * problem_.bands + band];
            }
        }
        for (std::uint32_t i = 0; i < patches; ++i) {
            add_sources(columns, i, band, first, fixed_fluxes, buried[i] != 0);
        }
        return columns;
    }

    /// Of what the schedule leaves alone, W/m².
    [[nodiscard]] double environment_beside(std::uint32_t band) const {
        if (std::count(condition_.begin(), condition_.end(), of_environment) == 0) {
            return environment_exitance(problem_)[band];
        }
        return problem_.environment.empty() ? 0.0 : problem_.environment[band];
    }

    void add_sources(NetworkSources& columns, std::uint32_t i, std::uint32_t k, std::uint32_t first,
                     const std::vector<double>& fixed_fluxes, bool buried) const {
        const std::uint32_t c = problem_.condition_of[i];
        const bool flux = has_flux(problem_, i);
        const std::size_t at = std::size_t{i} * problem_.bands + k;
        const double eps = problem_.emissivity[at];
        const auto changed =
            c == no_heat ? condition_.end() : std::find(condition_.begin(), condition_.end(), c);
        for (std::size_t s = first; s < std::size_t{first} + columns.columns; ++s) {
            columns.emissivity.push_back(flux ? 0.0 : eps);
            double source = 0.0;
            if (s < columns_ && changed == condition_.begin() + static_cast<std::ptrdiff_t>(s)) {
                source = flux ? (buried ? 0.0 : 1.0) : eps;
            } else if (s == columns_ && flux) {
                source = changed == condition_.end() && !buried ? fixed_fluxes[c] : 0.0;
            } else if (s == columns_) {
                source = problem_.exitance[at];
                if (c != no_heat && changed == condition_.end()) {
                    const double kelvin = *problem_.conditions[c].temperature;
                    source +=
                        eps * band_fractions(kelvin, problem_.band_limits)[k] * black_body_exitance(kelvin);
                }
            }
            columns.source.push_back(source);
        }
    }

    /// Area of every group by what tells its sigma T⁴, but for that of followers.
    struct Exposed {
        double area = 0.0; // with theirs
        double unknown = 0.0;
        std::map<std::uint32_t, double> given; // a condition with a temperature
    };

    [[nodiscard]] std::vector<Exposed> exposed_areas(const std::vector<std::uint8_t>& buried) {
        std::vector<Exposed> all(groups_);
        for (std::uint32_t i = 0; i < factors_.matrix.size(); ++i) {
            if (buried[i] != 0) {
                continue;
            }
            Exposed& exposed = all[factors_.group_of[i]];
            const double area = patch_area(i);
            const std::uint32_t c = problem_.condition_of[i];
            exposed.area += area;
            if (follows_irradiation(problem_, i)) {
                followers_.push_back(i);
            } else if (c == no_heat) {
                exposed.unknown += area;
            } else {
                exposed.given[c] += area;
            }
        }
        return all;
    }

    [[nodiscard]] double patch_area(std::uint32_t i) const {
        return factors_.areas[i] * problem_.unit * problem_.unit;
    }

    void superpose() {
        const ExchangeNetwork network = make_network(factors_, problem_);
        const std::vector<std::uint8_t> buried = buried_patches(network);
        refuse_singular(factors_, problem_, network, buried);
        const std::vector<Exposed> exposed = exposed_areas(buried);
        find_responses(network, buried);
        for (std::size_t l = 0; l < lines_; ++l) {
            with_line(l, [&] { add_line(l, exposed, condition_fluxes(factors_, at_line(l), buried)); });
        }
    }

    /// @param fluxes  of the line's conditions
    void add_line(std::size_t l, const std::vector<Exposed>& exposed, const std::vector<double>& fluxes) {
        const std::size_t sources = columns_ + 1;
        std::vector<double> net(groups_, 0.0);
        std::vector<double> arriving(followers_.size(), 0.0);
        std::vector<double> magnitude(followers_.size(), 0.0); // of what that is the sum of
        double environment = 0.0;
        for (std::size_t s = 0; s < sources; ++s) {
            std::vector<double> shares(problem_.bands, 1.0);
            double strength = 1.0;
            if (s < columns_ && is_temperature(s)) {
                strength = black_body_exitance(value(l, s));
                shares = band_fractions(value(l, s), problem_.band_limits);
            } else if (s < columns_) {
                strength = fluxes[condition_[s]];
            }
            for (std::uint32_t k = 0; k < problem_.bands; ++k) {
                const Response& response = responses_[std::size_t{k} * sources + s];
                const double factor = strength * shares[k];
                for (std::size_t g = 0; g < groups_; ++g) {
                    net[g] += factor * response.net[g];
                }
                for (std::size_t f = 0; f < arriving.size(); ++f) {
                    arriving[f] += factor * response.arriving[f];
                    magnitude[f] += std::abs(factor * response.arriving[f]);
                }
                environment += factor * response.environment;
            }
        }
        std::vector<double> power(groups_, 0.0); // area times sigma T⁴ of followers
        for (std::size_t f = 0; f < followers_.size(); ++f) {
            const std::uint32_t i = followers_[f];
            const std::uint32_t c = problem_.condition_of[i];
            const double flux = c == no_heat ? 0.0 : fluxes[c];
            const double x = power_by_irradiation(problem_, i, flux, arriving[f]);
            if (x < -1e-9 * magnitude[f]) {
                throw InputError(too_cold_text(factors_, i, flux));
            }
            power[factors_.group_of[i]] += patch_area(i) * (x < 0.0 ? 0.0 : x); // or not a number
        }
        for (std::size_t g = 0; g < groups_; ++g) {
            series_.net_power.push_back(net[g]);
            series_.net_flux.push_back(exposed[g].area > 0.0 ? net[g] / exposed[g].area : 0.0);
            series_.temperature.push_back(temperature(l, exposed[g], power[g]));
        }
        series_.environment_power.push_back(environment);
    }

    /// @param power  of followers, W
    [[nodiscard]] double temperature(std::size_t l, const Exposed& exposed, double power) const {
        if (exposed.unknown > 0.0 || exposed.area == 0.0 || !std::isfinite(power)) {
            return std::numeric_limits<double>::quiet_NaN();
        }
        for (const auto& [c, area] : exposed.given) {
            const auto column = std::find(condition_.begin(), condition_.end(), c);
            const double kelvin = column == condition_.end()
                                      ? *problem_.conditions[c].temperature
                                      : value(l, static_cast<std::size_t>(column - condition_.begin()));
            power += area * black_body_exitance(kelvin);
        }
        return black_body_temperature(power / exposed.area);
    }

    const FormFactors& factors_;
    HeatProblem problem_; // with one condition a column
    const HeatSchedule& schedule_;
    const HeatSettings& settings_;
    Observer& observer_;
    std::size_t columns_;
    std::size_t groups_;
    std::size_t lines_ = 0;
    std::vector<std::uint32_t> condition_; // of every column
    std::vector<std::uint32_t> followers_; // patches that are as hot as their irradiation and flux make them
    std::vector<Response> responses_;
    HeatSeries series_;
};

} // namespace

std::vector<HeatQuantity> check_heat_schedule(const std::vector<std::string>& groups,
                                              std::span<const std::uint32_t> group_of,
                                              const HeatProblem& problem, const HeatSchedule& schedule,
                                              Observer& observer) {
    HeatProblem changed = problem;
    std::vector<HeatQuantity> quantities;
    for (const std::uint32_t c : conditions_of(groups, group_of, changed, schedule)) {
        quantities.push_back(c == of_environment ? HeatQuantity::temperature : given(changed.conditions[c]));
    }
    warn_of_celsius(problem, schedule, quantities, observer);
    return quantities;
}

HeatSeries solve_heat_series(const FormFactors& factors, const HeatProblem& problem,
                             const HeatSchedule& schedule, const HeatSettings& settings, Observer& observer) {
    return Series(factors, problem, schedule, settings, observer).solve();
}

} // namespace hemi
