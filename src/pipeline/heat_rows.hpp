#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/heat.hpp"
#include "solver/exchange_network.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hemi {

/// Form factors as a network.
/// @throws InvalidArgument unless all rows are known, and reciprocal or with clusters, and the problem is of
///   as many patches
[[nodiscard]] ExchangeNetwork make_network(const FormFactors& factors, const HeatProblem& problem);

/// Columns that are solved side by side: every product reads the rows once for all of them. With clusters,
/// whose products need some six times as much memory a column, fewer.
[[nodiscard]] std::uint32_t columns_at_once(const FormFactorMatrix& factors);

/// e of every row; 0 in an enclosure, whose leaks come back: the environment gets nothing of it.
[[nodiscard]] std::vector<double> shares_of_environment(const FormFactors& factors);

/// By how much the irradiation of every patch, over all bands, would change if what arrives at the patches
/// were what their rows with clusters say, not what the symmetric exchange makes of these: to the first
/// order, where temperatures and fluxes are given, W/m², N.
[[nodiscard]] std::vector<double> asymmetry_changes(const ExchangeNetwork& network,
                                                    const FormFactors& factors, const HeatProblem& problem,
                                                    const HeatSolution& solution, Observer& observer);

/// 1 for every patch that sees nothing.
[[nodiscard]] std::vector<std::uint8_t> buried_patches(const ExchangeNetwork& network);

/// What the environment radiates in every band, W/m².
[[nodiscard]] std::vector<double> environment_exitance(const HeatProblem& problem);

/// Emissivity of a patch in a band at a temperature.
[[nodiscard]] double emissivity(const HeatProblem& problem, std::uint32_t patch, std::uint32_t band,
                                double kelvin);

/// Whether the flux of a patch is given, uniformly.
[[nodiscard]] bool has_flux(const HeatProblem& problem, std::uint32_t patch);

/// Whether the net flux of a patch is not given, neither by itself nor with others'.
[[nodiscard]] bool is_held(const HeatProblem& problem, std::uint32_t patch);

/// Whether a patch absorbs nothing in any band, nor emits by its temperature: it leaves what it is given.
[[nodiscard]] bool reflects_all(const HeatProblem& problem, std::uint32_t patch);

/// Whether a net flux is the exitance, but for rounding: what that of a perfect reflector must be.
[[nodiscard]] bool is_exitance(double flux, double exitance);

/// Of a patch, over all bands, W/m².
[[nodiscard]] double exitance_of(const HeatProblem& problem, std::uint32_t patch);

/// Whether the irradiation of an exposed patch tells its temperature with nothing else to be found: of grey
/// ones with a flux, and of perfect reflectors.
[[nodiscard]] bool follows_irradiation(const HeatProblem& problem, std::uint32_t patch);

/// sigma T⁴ of an exposed patch that follows_irradiation(), W/m²; not a number where any would do, or none.
/// Perfect reflectors are as hot as what they see. Below 0 where the flux is more than what arrives.
/// @param flux      given; not used where there is none
/// @param arriving  irradiation over all bands
[[nodiscard]] double power_by_irradiation(const HeatProblem& problem, std::uint32_t patch, double flux,
                                          double arriving);

/// What is wrong where a net flux is more than what a patch can take in at 0 K.
[[nodiscard]] std::string too_cold_text(const FormFactors& factors, std::uint32_t patch, double flux);

/// Values of which those that are not known count as 0, for sums in which they have no weight.
[[nodiscard]] std::vector<double> zero_where_unknown(std::vector<double> values);

/// Given net flux of every condition, W/m²; 0 where it has none.
/// @param buried  N; have no flux
/// @throws InputError for a power of patches that are all buried, naming a group of them
[[nodiscard]] std::vector<double> condition_fluxes(const FormFactors& factors, const HeatProblem& problem,
                                                   const std::vector<std::uint8_t>& buried);

/// @throws InputError where nothing holds the temperature of an enclosure, naming its groups
void refuse_singular(const FormFactors& factors, const HeatProblem& problem, const ExchangeNetwork& network,
                     const std::vector<std::uint8_t>& buried);

/// As solve_heat() on the problem's network, without its warnings.
[[nodiscard]] HeatSolution solve_heat_network(const ExchangeNetwork& network, const FormFactors& factors,
                                              const HeatProblem& problem, const HeatSettings& settings,
                                              Observer& observer);

/// Progress of a linear solve, for the observer.
[[nodiscard]] ExchangeNetwork::Watcher heat_progress(Observer& observer, double tolerance);

} // namespace hemi
