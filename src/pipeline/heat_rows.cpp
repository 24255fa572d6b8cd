#include "pipeline/heat_rows.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/pipeline/diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace hemi {

namespace {

/// Whether the temperature of a patch is found with others' of its group.
bool is_isothermal(const HeatProblem& problem, std::uint32_t patch) {
    const std::uint32_t c = problem.condition_of[patch];
    return c != no_heat && problem.conditions[c].isothermal && !problem.conditions[c].temperature;
}

/// Whether something holds the radiosity of a patch, whatever the others do.
bool holds(const HeatProblem& problem, std::uint32_t patch) {
    return is_held(problem, patch) && !reflects_all(problem, patch);
}

/// What is known of an enclosure.
struct Enclosed {
    bool held = false;
    bool seen = false; ///< some patch of it is not covered
    double lost = 0.0;
    double area = 0.0;
    double power = 0.0;
    double magnitude = 0.0;
    std::set<std::uint32_t> groups;
};

std::string names_text(const std::set<std::uint32_t>& groups, const std::vector<std::string>& names) {
    constexpr std::size_t most = 6;
    std::vector<std::string> shown;
    for (const std::uint32_t g : groups) {
        if (shown.size() == most) {
            shown.push_back(fmt::format("{} more", groups.size() - most));
            break;
        }
        shown.push_back(names[g]);
    }
    return fmt::format("{}", fmt::join(shown, ", "));
}

} // namespace

bool has_flux(const HeatProblem& problem, std::uint32_t patch) {
    const std::uint32_t c = problem.condition_of[patch];
    return c != no_heat && !problem.conditions[c].temperature && !problem.conditions[c].isothermal;
}

bool is_held(const HeatProblem& problem, std::uint32_t patch) {
    const std::uint32_t c = problem.condition_of[patch];
    return c == no_heat || problem.conditions[c].temperature;
}

bool reflects_all(const HeatProblem& problem, std::uint32_t patch) {
    const auto first = problem.emissivity.begin() + static_cast<std::ptrdiff_t>(patch) * problem.bands;
    return problem.table_of[patch] == no_heat &&
           std::all_of(first, first + problem.bands, [](double eps) { return eps == 0.0; });
}

bool is_exitance(double flux, double exitance) {
    constexpr double rounding = 1e-12; // of a power over an area
    return std::abs(flux - exitance) <= rounding * std::max(std::abs(flux), exitance);
}

double exitance_of(const HeatProblem& problem, std::uint32_t patch) {
    const auto first = problem.exitance.begin() + static_cast<std::ptrdiff_t>(patch) * problem.bands;
    return std::accumulate(first, first + problem.bands, 0.0);
}

bool follows_irradiation(const HeatProblem& problem, std::uint32_t patch) {
    if (problem.condition_of[patch] == no_heat || (problem.bands > 1 && has_flux(problem, patch))) {
        return reflects_all(problem, patch);
    }
    return has_flux(problem, patch) && problem.table_of[patch] == no_heat;
}

double power_by_irradiation(const HeatProblem& problem, std::uint32_t patch, double flux, double arriving) {
    const double exitance = exitance_of(problem, patch);
    if (reflects_all(problem, patch)) {
        const double net = problem.condition_of[patch] == no_heat ? 0.0 : flux;
        return is_exitance(net, exitance) ? arriving : std::numeric_limits<double>::quiet_NaN();
    }
    return arriving + (flux - exitance) / problem.emissivity[std::size_t{patch} * problem.bands];
}

std::string too_cold_text(const FormFactors& factors, std::uint32_t patch, double flux) {
    return fmt::format("group {}: a net flux of {:.6g} W/m² would need a temperature below 0 K at patch {}: "
                       "less than that arrives there",
                       factors.groups[factors.group_of[patch]], flux, patch);
}

std::vector<double> zero_where_unknown(std::vector<double> values) {
    for (double& value : values) {
        value = std::isfinite(value) ? value : 0.0;
    }
    return values;
}

double emissivity(const HeatProblem& problem, std::uint32_t patch, std::uint32_t band, double kelvin) {
    const std::uint32_t table = problem.table_of[patch];
    if (table == no_heat || !std::isfinite(kelvin)) {
        return problem.emissivity[std::size_t{patch} * problem.bands + band];
    }
    return emissivity_at(problem.tables[table], kelvin);
}

std::vector<double> environment_exitance(const HeatProblem& problem) {
    std::vector<double> exitance = problem.environment;
    exitance.resize(problem.bands, 0.0);
    const double kelvin = problem.environment_temperature.value_or(0.0);
    const std::vector<double> shares = band_fractions(kelvin, problem.band_limits);
    for (std::uint32_t k = 0; k < problem.bands; ++k) {
        exitance[k] += shares[k] * black_body_exitance(kelvin);
    }
    return exitance;
}

std::vector<std::uint8_t> buried_patches(const ExchangeNetwork& network) {
    constexpr double nothing = 1e-6;
    std::vector<std::uint8_t> buried(network.size(), 0);
    for (std::uint32_t i = 0; i < network.size(); ++i) {
        buried[i] = network.exchanging(i) < nothing ? 1 : 0;
    }
    return buried;
}

std::vector<double> condition_fluxes(const FormFactors& factors, const HeatProblem& problem,
                                     const std::vector<std::uint8_t>& buried) {
    std::vector<double> areas(problem.conditions.size(), 0.0);
    std::vector<std::uint32_t> some(problem.conditions.size(), no_heat); // a patch of each
    for (std::uint32_t i = 0; i < factors.matrix.size(); ++i) {
        const std::uint32_t c = problem.condition_of[i];
        if (c != no_heat) {
            areas[c] += buried[i] == 0 ? factors.areas[i] * problem.unit * problem.unit : 0.0;
            some[c] = i;
        }
    }
    std::vector<double> fluxes;
    for (std::size_t c = 0; c < areas.size(); ++c) {
        const HeatCondition& condition = problem.conditions[c];
        if (condition.power.value_or(0.0) != 0.0 && some[c] != no_heat && !(areas[c] > 0.0)) {
            throw InputError(fmt::format("group {}: a power of {:.6g} W cannot leave: all of its patches are "
                                         "buried",
                                         factors.groups[factors.group_of[some[c]]], *condition.power));
        }
        const double of_power = condition.power && areas[c] > 0.0 ? *condition.power / areas[c] : 0.0;
        fluxes.push_back(condition.heat_flux.value_or(of_power));
    }
    return fluxes;
}

ExchangeNetwork make_network(const FormFactors& factors, const HeatProblem& problem) {
    const std::uint32_t size = factors.matrix.size();
    const std::size_t values = std::size_t{size} * problem.bands;
    if (problem.emissivity.size() != values || problem.exitance.size() != values ||
        problem.condition_of.size() != size || problem.table_of.size() != size ||
        problem.band_limits.size() + 1 != problem.bands || factors.areas.size() != size) {
        throw InvalidArgument(
            fmt::format("a heat problem of {} patches and {} bands does not fit {} rows and {} areas",
                        problem.condition_of.size(), problem.bands, size, factors.areas.size()));
    }
    if (!factors.matrix.all_known()) {
        throw InvalidArgument("heat exchange needs the rows of all patches, and some are unknown");
    }
    if (factors.matrix.clusters() == nullptr && !is_reciprocal(reciprocity(factors.matrix, factors.areas))) {
        throw InvalidArgument("heat exchange needs reciprocal rows; repair them (closure or reciprocity)",
                              {"repair"});
    }
    // What little a covered patch sees by the sampling of its visibility is not there.
    constexpr double all_of_it = 0.999;
    std::vector<std::uint8_t> isolated(size, 0);
    for (std::uint32_t i = 0; i < size; ++i) {
        isolated[i] = factors.matrix.blocked(i) > all_of_it ? 1 : 0;
    }
    return ExchangeNetwork(factors.matrix, factors.areas, shares_of_environment(factors),
                           std::move(isolated));
}

std::uint32_t columns_at_once(const FormFactorMatrix& factors) {
    return factors.clusters() == nullptr ? 16 : 4;
}

std::vector<double> shares_of_environment(const FormFactors& factors) {
    std::vector<double> shares(factors.matrix.size(), 0.0);
    if (find_leaks(factors, 0.0).closed) {
        return shares;
    }
    for (std::uint32_t i = 0; i < factors.matrix.size(); ++i) {
        shares[i] = factors.matrix.environment(i);
    }
    return shares;
}

void refuse_singular(const FormFactors& factors, const HeatProblem& problem, const ExchangeNetwork& network,
                     const std::vector<std::uint8_t>& buried) {
    std::vector<std::uint32_t> enclosure = network.enclosures();
    // Patches of one unknown temperature are connected by it, unless they take nothing of it.
    std::map<std::uint32_t, std::uint32_t> merged;
    const auto root = [&merged](std::uint32_t e) {
        for (auto found = merged.find(e); found != merged.end(); found = merged.find(e)) {
            e = found->second;
        }
        return e;
    };
    std::vector<std::uint32_t> of_condition(problem.conditions.size(), no_heat);
    for (std::uint32_t i = 0; i < network.size(); ++i) {
        if (buried[i] == 0 && is_isothermal(problem, i) && !reflects_all(problem, i)) {
            std::uint32_t& first = of_condition[problem.condition_of[i]];
            if (first == no_heat) {
                first = enclosure[i];
            } else if (root(first) != root(enclosure[i])) {
                merged[root(enclosure[i])] = root(first);
            }
        }
    }
    const std::vector<double> fluxes = condition_fluxes(factors, problem, buried);
    std::map<std::uint32_t, Enclosed> all;
    for (std::uint32_t i = 0; i < network.size(); ++i) {
        if (buried[i] != 0) {
            continue;
        }
        Enclosed& enclosed = all[root(enclosure[i])];
        const double area = factors.areas[i] * problem.unit * problem.unit;
        enclosed.held = enclosed.held || holds(problem, i);
        enclosed.seen = enclosed.seen || factors.matrix.blocked(i) <= buried_above;
        enclosed.lost += area * network.environment()[i];
        enclosed.area += area;
        enclosed.groups.insert(factors.group_of[i]);
        // What absorbs nothing gives its exitance, whatever its temperature.
        const double flux = is_held(problem, i) ? exitance_of(problem, i) : fluxes[problem.condition_of[i]];
        enclosed.power += area * flux;
        enclosed.magnitude += area * std::abs(flux);
    }
    for (const auto& [first, enclosed] : all) {
        if (enclosed.held || !enclosed.seen || enclosed.lost > 1e-9 * enclosed.area) {
            continue;
        }
        const std::string names = names_text(enclosed.groups, factors.groups);
        if (std::abs(enclosed.power) <= 1e-9 * enclosed.magnitude) {
            throw InputError(
                fmt::format("no surface of the enclosure of {} that absorbs has a temperature, and their "
                            "heat fluxes and exitances balance: any temperature is a solution; give one of "
                            "them a temperature",
                            names));
        }
        throw InputError(
            fmt::format("no surface of the enclosure of {} that absorbs has a temperature, and their heat "
                        "fluxes and exitances leave {:.6g} W that cannot go anywhere: there is no solution; "
                        "give one of them a temperature",
                        names, enclosed.power));
    }
}

ExchangeNetwork::Watcher heat_progress(Observer& observer, double tolerance) {
    const double target = std::log(tolerance);
    return [target, &observer](std::uint32_t, double residual) {
        const double share = residual > 0.0 ? std::log(residual) / target : 1.0;
        return observer.progress(Phase::radiosity,
                                 static_cast<std::size_t>(100.0 * std::clamp(share, 0.0, 1.0)), 100);
    };
}

} // namespace hemi
