#include "hemi/pipeline/heat.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "pipeline/anderson.hpp"
#include "pipeline/heat_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

namespace hemi {

namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// The x >= 0 with excess(x) = 0, excess being increasing and hardly curved; 0 where it is positive there;
/// nothing where it never gets there.
/// @param guess  about where
std::optional<double> root_of(const std::function<double(double)>& excess, double guess) {
    double low = 0.0;
    double at_low = excess(low);
    if (at_low >= 0.0) {
        return low;
    }
    double high = guess > 0.0 ? guess : 1.0;
    double at_high = excess(high);
    while (at_high < 0.0 && high < 1e30) {
        low = high;
        at_low = at_high;
        high *= 2.0;
        at_high = excess(high);
    }
    if (!(at_high >= 0.0)) {
        return std::nullopt;
    }
    // The Illinois rule: secants that halve the weight of an end which stays.
    int side = 0;
    for (int step = 0; step < 200 && high - low > 1e-15 * high; ++step) {
        double middle = (low * at_high - high * at_low) / (at_high - at_low);
        if (!(middle > low && middle < high)) {
            middle = 0.5 * (low + high);
        }
        const double value = excess(middle);
        if (value == 0.0) {
            return middle;
        }
        if (value < 0.0) {
            low = middle;
            at_low = value;
            at_high *= side == -1 ? 0.5 : 1.0;
            side = -1;
        } else {
            high = middle;
            at_high = value;
            at_low *= side == 1 ? 0.5 : 1.0;
            side = 1;
        }
        if (std::abs(value) <= 1e-15 * (std::abs(at_low) + std::abs(at_high)) && step > 100) {
            break;
        }
    }
    return 0.5 * (low + high);
}

class HeatSolver {
public:
    HeatSolver(const ExchangeNetwork& network, const FormFactors& factors, const HeatProblem& problem,
               const HeatSettings& settings, Observer& observer)
        : factors_(factors), problem_(problem), settings_(settings), observer_(observer), network_(network),
          buried_(buried_patches(network_)), fluxes_(condition_fluxes(factors, problem, buried_)),
          unknown_of_(network_.size(), no_heat), power_(network_.size(), 0.0) {
        refuse_singular(factors, problem, network_, buried_);
        find_given();
        find_unknowns();
        set_aside();
    }

    HeatSolution solve() {
        std::vector<double> x(unknowns_.size(), first_guess());
        solve_field(x);
        if (!x.empty()) {
            iterate(x);
        }
        return collect();
    }

private:
    /// Patches that have one unknown temperature together.
    struct Unknown {
        std::vector<std::uint32_t> patches;
        double flux = 0.0; // given, W/m², mean
    };

    [[nodiscard]] std::uint32_t size() const { return network_.size(); }
    [[nodiscard]] std::size_t at(std::uint32_t i, std::uint32_t k) const {
        return std::size_t{i} * problem_.bands + k;
    }
    /// Whether the flux is a source of the linear system: in one band, emissivity does not matter then.
    [[nodiscard]] bool is_flux_source(std::uint32_t i) const {
        return problem_.bands == 1 && has_flux(problem_, i);
    }

    /// sigma T⁴ of patches whose temperature is given; not a number of others.
    void find_given() {
        for (std::uint32_t i = 0; i < size(); ++i) {
            const std::uint32_t c = problem_.condition_of[i];
            const auto kelvin = c == no_heat ? std::nullopt : problem_.conditions[c].temperature;
            power_[i] = kelvin ? black_body_exitance(*kelvin) : not_known;
        }
    }

    void find_unknowns() {
        std::vector<std::uint32_t> of_condition(problem_.conditions.size(), no_heat);
        for (std::uint32_t i = 0; i < size(); ++i) {
            const std::uint32_t c = problem_.condition_of[i];
            if (c == no_heat || problem_.conditions[c].temperature || is_flux_source(i)) {
                continue;
            }
            const bool alone = !problem_.conditions[c].isothermal;
            if (alone && buried_[i] != 0) {
                continue;
            }
            if (alone || of_condition[c] == no_heat) {
                of_condition[c] = static_cast<std::uint32_t>(unknowns_.size());
                unknowns_.push_back({{}, fluxes_[c]});
            }
            unknown_of_[i] = of_condition[c];
            unknowns_[of_condition[c]].patches.push_back(i);
        }
    }

    /// Takes out of the unknowns those that no balance tells: patches that are all buried, and perfect
    /// reflectors, whose net flux is their exitance.
    void set_aside() {
        std::vector<Unknown> left;
        for (Unknown& unknown : unknowns_) {
            double area = 0.0;
            double own = 0.0;
            bool absorbs = false;
            for (const std::uint32_t i : unknown.patches) {
                if (buried_[i] == 0) {
                    area += factors_.areas[i];
                    own += factors_.areas[i] * exitance_of(problem_, i);
                    absorbs = absorbs || !reflects_all(problem_, i);
                }
            }
            const bool stays = area > 0.0 && absorbs;
            for (const std::uint32_t i : unknown.patches) {
                unknown_of_[i] = stays ? static_cast<std::uint32_t>(left.size()) : no_heat;
            }
            if (stays) {
                left.push_back(std::move(unknown));
            } else if (area > 0.0) {
                refuse_flux_of_reflector(unknown, own / area);
                reflectors_.push_back(std::move(unknown));
            }
        }
        unknowns_ = std::move(left);
    }

    void refuse_flux_of_reflector(const Unknown& unknown, double exitance) const {
        if (!is_exitance(unknown.flux, exitance)) {
            throw InputError(
                fmt::format("group {}: its emissivity is 0, so that its net flux is its exitance, {:.6g} "
                            "W/m², and cannot be {:.6g} W/m²; give it an emissivity above 0",
                            group_name(unknown.patches.front()), exitance, unknown.flux));
        }
    }

    [[nodiscard]] const std::string& group_name(std::uint32_t i) const {
        return factors_.groups[factors_.group_of[i]];
    }

    [[nodiscard]] double first_guess() const {
        double sum = 0.0;
        double weight = 0.0;
        for (std::uint32_t i = 0; i < size(); ++i) {
            if (std::isfinite(power_[i])) {
                sum += factors_.areas[i] * power_[i];
                weight += factors_.areas[i];
            }
        }
        if (weight > 0.0) {
            return sum / weight;
        }
        for (const double exitance : environment_exitance(problem_)) {
            sum += exitance;
        }
        for (const double flux : fluxes_) {
            sum += std::abs(flux);
        }
        return sum;
    }

    void solve_field(const std::vector<double>& x) {
        for (std::size_t u = 0; u < x.size(); ++u) {
            for (const std::uint32_t i : unknowns_[u].patches) {
                power_[i] = x[u];
            }
        }
        sources_.columns = problem_.bands;
        sources_.emissivity.assign(std::size_t{size()} * problem_.bands, 0.0);
        sources_.source = sources_.emissivity;
        sources_.environment = environment_exitance(problem_);
        sources_.direct = problem_.direct;
        for (std::uint32_t i = 0; i < size(); ++i) {
            if (is_flux_source(i)) {
                sources_.source[i] = buried_[i] != 0 ? 0.0 : fluxes_[problem_.condition_of[i]];
                continue;
            }
            const double kelvin = std::isfinite(power_[i]) ? black_body_temperature(power_[i]) : not_known;
            const std::vector<double> shares = fractions(kelvin);
            for (std::uint32_t k = 0; k < problem_.bands; ++k) {
                const double eps = emissivity(problem_, i, k, kelvin);
                sources_.emissivity[at(i, k)] = eps;
                sources_.source[at(i, k)] = problem_.exitance[at(i, k)];
                if (std::isfinite(power_[i])) {
                    sources_.source[at(i, k)] += eps * shares[k] * power_[i];
                }
            }
        }
        const std::uint32_t before = fluxes_found_.iterations;
        fluxes_found_ =
            network_.solve(sources_, settings_.tolerance, heat_progress(observer_, settings_.tolerance));
        fluxes_found_.iterations += before;
    }

    [[nodiscard]] std::vector<double> fractions(double kelvin) const {
        return band_fractions(std::isfinite(kelvin) ? kelvin : 0.0, problem_.band_limits);
    }

    /// Net flux of a patch in the field as it is, if its sigma T⁴ were x.
    [[nodiscard]] double net_flux(std::uint32_t i, double x) const {
        const double kelvin = black_body_temperature(x);
        const std::vector<double> shares = fractions(kelvin);
        double sum = 0.0;
        for (std::uint32_t k = 0; k < problem_.bands; ++k) {
            sum +=
                emissivity(problem_, i, k, kelvin) * (shares[k] * x - fluxes_found_.irradiation[at(i, k)]) +
                problem_.exitance[at(i, k)];
        }
        return sum;
    }

    /// sigma T⁴ by which patches have their flux in the field as it is.
    [[nodiscard]] double balanced(const std::vector<std::uint32_t>& patches, double flux,
                                  double guess) const {
        const auto excess = [&](double x) {
            double sum = 0.0;
            for (const std::uint32_t i : patches) {
                if (buried_[i] == 0) {
                    sum += factors_.areas[i] * (net_flux(i, x) - flux);
                }
            }
            return sum;
        };
        const std::optional<double> root = root_of(excess, guess);
        if (!root) {
            throw InputError(fmt::format("group {}: no temperature makes a net flux of {:.6g} W/m², by its "
                                         "emissivity; give it one that is above 0 where it radiates",
                                         group_name(patches.front()), flux));
        }
        return *root;
    }

    void iterate(std::vector<double>& x) {
        constexpr std::size_t window = 10;
        Anderson anderson(window);
        const double scale_before = first_guess();
        for (outer_ = 1;; ++outer_) {
            std::vector<double> g(x.size());
            double largest = scale_before;
            outer_change_ = 0.0;
            for (std::size_t u = 0; u < x.size(); ++u) {
                g[u] = balanced(unknowns_[u].patches, unknowns_[u].flux, x[u]);
                outer_change_ = std::max(outer_change_, std::abs(g[u] - x[u]));
                largest = std::max(largest, g[u]);
            }
            outer_change_ /= largest > 0.0 ? largest : 1.0;
            if (outer_change_ <= settings_.outer_tolerance) {
                break;
            }
            if (outer_ >= settings_.max_outer) {
                throw NotConverged(
                    fmt::format("heat: temperatures still change by {:.3g} of sigma T⁴ after {} "
                                "outer iterations; {:.3g} was to be reached",
                                outer_change_, outer_, settings_.outer_tolerance));
            }
            x = anderson.next(x, g);
            for (double& value : x) {
                value = std::max(value, 0.0);
            }
            solve_field(x);
        }
        for (std::size_t u = 0; u < x.size(); ++u) {
            refuse_cold(unknowns_[u].patches.front(), x[u], unknowns_[u].flux);
        }
    }

    /// Where the flux is more than what patches can take in at 0 K.
    void refuse_cold(std::uint32_t i, double x, double flux) const {
        if (x > 0.0) {
            return;
        }
        double sum = 0.0;
        double area = 0.0;
        const std::uint32_t u = unknown_of_[i];
        for (const std::uint32_t patch :
             u == no_heat ? std::vector<std::uint32_t>{i} : unknowns_[u].patches) {
            sum += factors_.areas[patch] * (buried_[patch] == 0 ? net_flux(patch, 0.0) : 0.0);
            area += factors_.areas[patch] * (buried_[patch] == 0 ? 1.0 : 0.0);
        }
        if (area > 0.0 && sum > flux * area + 1e-9 * std::abs(sum)) {
            throw InputError(too_cold_text(factors_, i, flux));
        }
    }

    /// Over all bands.
    [[nodiscard]] double arriving(std::uint32_t i) const {
        const auto first = fluxes_found_.irradiation.begin() + static_cast<std::ptrdiff_t>(at(i, 0));
        return std::accumulate(first, first + problem_.bands, 0.0);
    }

    /// sigma T⁴ of a patch by the field that was found.
    [[nodiscard]] double final_power(std::uint32_t i) const {
        if (buried_[i] != 0 || std::isfinite(power_[i])) {
            return power_[i];
        }
        const std::uint32_t c = problem_.condition_of[i];
        const double flux = c == no_heat ? 0.0 : fluxes_[c];
        if (follows_irradiation(problem_, i)) {
            const double x = power_by_irradiation(problem_, i, flux, arriving(i));
            if (x < -1e-9 * arriving(i)) {
                throw InputError(too_cold_text(factors_, i, flux));
            }
            return x < 0.0 ? 0.0 : x; // or not a number
        }
        if (!is_flux_source(i)) {
            return not_known;
        }
        const double x = balanced({i}, flux, arriving(i));
        refuse_cold(i, x, flux);
        return x;
    }

    /// Perfect reflectors of one temperature: as hot as what they see together.
    void find_reflectors() {
        for (const Unknown& reflector : reflectors_) {
            double sum = 0.0;
            double area = 0.0;
            for (const std::uint32_t i : reflector.patches) {
                sum += buried_[i] == 0 ? factors_.areas[i] * arriving(i) : 0.0;
                area += buried_[i] == 0 ? factors_.areas[i] : 0.0;
            }
            for (const std::uint32_t i : reflector.patches) {
                power_[i] = sum / area;
            }
        }
    }

    HeatSolution collect() {
        find_reflectors();
        HeatSolution solution;
        solution.bands = problem_.bands;
        solution.radiosity = std::move(fluxes_found_.radiosity);
        solution.irradiation = fluxes_found_.irradiation;
        solution.buried = buried_;
        solution.iterations = fluxes_found_.iterations;
        solution.residual = fluxes_found_.residual;
        solution.outer = outer_;
        solution.outer_change = outer_change_;
        solution.asymmetry = network_.asymmetry();
        for (std::uint32_t i = 0; i < size(); ++i) {
            collect_patch(solution, i);
        }
        balance(solution);
        return solution;
    }

    void collect_patch(HeatSolution& solution, std::uint32_t i) const {
        const double x = final_power(i);
        const double kelvin = std::isfinite(x) ? black_body_temperature(x) : not_known;
        double absorbed = 0.0;
        double net = 0.0;
        for (std::uint32_t k = 0; k < problem_.bands; ++k) {
            const double arriving = fluxes_found_.irradiation[at(i, k)];
            const double eps = emissivity(problem_, i, k, kelvin);
            absorbed += eps * arriving;
            net += sources_.source[at(i, k)] - sources_.emissivity[at(i, k)] * arriving;
            if (buried_[i] != 0 && (eps == 0.0 || !std::isfinite(x))) {
                solution.radiosity[at(i, k)] = solution.irradiation[at(i, k)] = not_known;
            }
        }
        if (buried_[i] != 0) {
            net = 0.0;
            absorbed = std::isfinite(x) ? absorbed : not_known;
        }
        solution.temperature.push_back(kelvin);
        solution.absorbed.push_back(absorbed);
        solution.emitted.push_back(net + absorbed);
        solution.net_flux.push_back(net);
    }

    void balance(HeatSolution& solution) const {
        const double unit = problem_.unit * problem_.unit;
        const std::vector<double> bright = environment_exitance(problem_);
        std::vector<double> powers(factors_.groups.size(), 0.0);
        double emitted = 0.0;
        for (std::uint32_t i = 0; i < size(); ++i) {
            if (buried_[i] != 0) {
                continue;
            }
            const double area = factors_.areas[i] * unit;
            powers[factors_.group_of[i]] += area * solution.net_flux[i];
            emitted += area * solution.emitted[i];
            for (std::uint32_t k = 0; k < problem_.bands; ++k) {
                const double direct = problem_.direct.empty() ? 0.0 : problem_.direct[at(i, k)];
                solution.environment_power +=
                    area * (network_.environment()[i] * (bright[k] - solution.radiosity[at(i, k)]) + direct);
            }
        }
        double magnitude = std::abs(solution.environment_power);
        solution.balance = solution.environment_power;
        for (const double power : powers) {
            solution.balance += power;
            magnitude += std::abs(power);
        }
        constexpr double rounding = 1e-12; // an enclosure of one temperature has no net powers
        solution.relative_balance =
            magnitude > rounding * emitted ? std::abs(solution.balance) / magnitude : 0.0;
    }

    const FormFactors& factors_;
    const HeatProblem& problem_;
    const HeatSettings& settings_;
    Observer& observer_;
    const ExchangeNetwork& network_;
    std::vector<std::uint8_t> buried_;
    std::vector<double> fluxes_; // of every condition
    std::vector<Unknown> unknowns_;
    std::vector<Unknown> reflectors_;       // emissivity 0, several patches with one temperature or bands
    std::vector<std::uint32_t> unknown_of_; // of every patch
    std::vector<double> power_;             // sigma T⁴ of every patch
    NetworkSources sources_;
    NetworkFluxes fluxes_found_;
    std::uint32_t outer_ = 0;
    double outer_change_ = 0.0;
};

/// Of an environment that counts as 0 K, or does not count.
void warn_of_environment(const FormFactors& factors, const HeatProblem& problem,
                         const ExchangeNetwork& network, Observer& observer) {
    double seen = 0.0;
    double area = 0.0;
    for (std::uint32_t i = 0; i < network.size(); ++i) {
        seen += factors.areas[i] * network.environment()[i];
        area += factors.areas[i];
    }
    const std::vector<double> bright = environment_exitance(problem);
    const bool dark = std::none_of(bright.begin(), bright.end(), [](double value) { return value > 0.0; });
    if (problem.environment_temperature && seen == 0.0) {
        observer.warning(
            fmt::format("the environment's temperature, {:.6g} K, does not count: no surface sees "
                        "the environment",
                        *problem.environment_temperature),
            "environment-temperature");
    } else if (!problem.environment_temperature && dark && seen > 0.0) {
        observer.warning(fmt::format("the scene is open to an environment without temperature, which counts "
                                     "as 0 K ({:.3g} % of what leaves surfaces goes there)",
                                     100.0 * seen / area),
                         "environment-temperature");
    }
}

/// What the mean irradiation of every group is off by, W/m², by its sampled rows: their mean and its standard
/// error together; by all rows where a group has hardly any; not a number where there are none. With
/// clusters, what makes their exchange symmetric comes on top.
std::vector<double> irradiation_errors(const FormFactors& factors, const HeatProblem& problem,
                                       const HeatSolution& solution) {
    const std::size_t groups = factors.groups.size();
    std::vector<double> sums(groups + 1, 0.0);
    std::vector<double> squares(groups + 1, 0.0);
    std::vector<std::size_t> counts(groups + 1, 0);
    std::vector<double> asymmetry(groups + 1, 0.0); // times the area
    std::vector<double> areas(groups + 1, 0.0);
    for (std::uint32_t i = 0; i < solution.asymmetry_change.size(); ++i) {
        for (const std::size_t g : {std::size_t{factors.group_of[i]}, groups}) {
            asymmetry[g] += factors.areas[i] * solution.asymmetry_change[i];
            areas[g] += solution.buried[i] == 0 ? factors.areas[i] : 0.0;
        }
    }
    if (factors.reference.size() == factors.matrix.size()) {
        const std::vector<double> radiosity = zero_where_unknown(solution.radiosity);
        const IrradianceErrors errors = irradiance_errors(factors.matrix, factors.reference, problem.bands,
                                                          radiosity, environment_exitance(problem));
        // What a row has too much comes out of what the patch sends itself.
        const std::vector<double> ones(factors.matrix.size(), 1.0);
        const IrradianceErrors excess =
            irradiance_errors(factors.matrix, factors.reference, 1, ones, std::vector<double>{1.0});
        for (std::size_t k = 0; k < errors.rows.size(); ++k) {
            if (solution.buried[errors.rows[k]] != 0) {
                continue;
            }
            double sum = 0.0;
            for (std::uint32_t b = 0; b < problem.bands; ++b) {
                sum += errors.errors[k * problem.bands + b] -
                       excess.errors[k] * radiosity[std::size_t{errors.rows[k]} * problem.bands + b];
            }
            for (const std::size_t g : {std::size_t{factors.group_of[errors.rows[k]]}, groups}) {
                sums[g] += sum;
                squares[g] += sum * sum;
                ++counts[g];
            }
        }
    }
    constexpr std::size_t few = 4;
    std::vector<double> result;
    for (std::size_t g = 0; g <= groups; ++g) {
        const std::size_t from = counts[g] < few ? groups : g;
        const auto count = static_cast<double>(counts[from]);
        const double mean = sums[from] / count; // not a number where there are none
        const double spread = std::max(squares[from] / count - mean * mean, 0.0);
        result.push_back(std::hypot(mean, count > 1.0 ? std::sqrt(spread / (count - 1.0)) : 0.0,
                                    areas[g] > 0.0 ? asymmetry[g] / areas[g] : 0.0));
    }
    return result;
}

} // namespace

HeatSolution solve_heat(const FormFactors& factors, const HeatProblem& problem, const HeatSettings& settings,
                        Observer& observer) {
    const ExchangeNetwork network = make_network(factors, problem);
    warn_of_environment(factors, problem, network, observer);
    HeatSolution solution = solve_heat_network(network, factors, problem, settings, observer);
    if (factors.matrix.clusters() != nullptr) {
        solution.asymmetry_change = asymmetry_changes(network, factors, problem, solution, observer);
    }
    return solution;
}

HeatSolution solve_heat_network(const ExchangeNetwork& network, const FormFactors& factors,
                                const HeatProblem& problem, const HeatSettings& settings,
                                Observer& observer) {
    return HeatSolver(network, factors, problem, settings, observer).solve();
}

std::vector<GroupHeat> group_heat(const FormFactors& factors, const HeatProblem& problem,
                                  const HeatSolution& solution) {
    const std::size_t groups = factors.groups.size();
    const double unit = problem.unit * problem.unit;
    std::vector<GroupHeat> all(groups + 1);
    std::vector<double> exposed(groups + 1, 0.0);
    std::vector<double> power(groups + 1, 0.0);   // sigma T⁴
    std::vector<double> by_heat(groups + 1, 0.0); // eps sigma T⁴
    std::vector<double> held(groups + 1, 0.0);    // eps where the flux is not given
    std::vector<double> covered(groups + 1, 0.0); // eps of buried patches
    for (std::uint32_t i = 0; i < factors.matrix.size(); ++i) {
        const double area = factors.areas[i] * unit;
        const bool buried = solution.buried[i] != 0;
        for (const std::size_t g : {std::size_t{factors.group_of[i]}, groups}) {
            GroupHeat& heat = all[g];
            heat.area += area;
            const double kelvin = solution.temperature[i];
            const double x = black_body_exitance(kelvin);
            const std::vector<double> shares =
                band_fractions(std::isfinite(kelvin) ? kelvin : 0.0, problem.band_limits);
            double eps = 0.0;
            for (std::uint32_t k = 0; k < problem.bands; ++k) {
                const std::size_t at = std::size_t{i} * problem.bands + k;
                const double weight = std::isfinite(kelvin) ? shares[k] : 1.0 / problem.bands;
                eps += weight * emissivity(problem, i, k, kelvin);
                heat.irradiation += buried ? 0.0 : area * solution.irradiation[at];
                heat.direct += buried || problem.direct.empty() ? 0.0 : area * problem.direct[at];
                heat.radiosity += buried ? 0.0 : area * solution.radiosity[at];
            }
            if (buried) {
                covered[g] += area * eps;
                continue;
            }
            exposed[g] += area;
            power[g] += area * x;
            by_heat[g] += area * eps * x;
            heat.emissivity += area * eps;
            heat.emitted += area * solution.emitted[i];
            heat.absorbed += area * solution.absorbed[i];
            heat.net_power += area * solution.net_flux[i];
            held[g] += is_held(problem, i) ? area * eps : 0.0;
        }
    }
    const std::vector<double> errors = irradiation_errors(factors, problem, solution);
    for (std::size_t g = 0; g <= groups; ++g) {
        GroupHeat& heat = all[g];
        const double area = exposed[g] > 0.0 ? exposed[g] : 1.0;
        for (double GroupHeat::*mean : {&GroupHeat::emissivity, &GroupHeat::emitted, &GroupHeat::absorbed,
                                        &GroupHeat::irradiation, &GroupHeat::direct, &GroupHeat::radiosity}) {
            heat.*mean = exposed[g] > 0.0 ? heat.*mean / area : not_known;
        }
        if (exposed[g] == 0.0) {
            heat.emissivity = heat.area > 0.0 ? covered[g] / heat.area : not_known;
        }
        if (power[g] > 0.0) { // not where it is not a number
            heat.emissivity = by_heat[g] / power[g];
        }
        heat.net_flux = heat.net_power / area;
        heat.temperature =
            exposed[g] > 0.0 && std::isfinite(power[g]) ? black_body_temperature(power[g] / area) : not_known;
        heat.flux_error = errors[g] * held[g] / area;
    }
    return all;
}

} // namespace hemi
