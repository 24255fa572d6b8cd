#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/heat.hpp"
#include "solver/exchange_network.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hemi {

/// Form factors as a network.
/// @throws InvalidArgument unless all rows are known and reciprocal and the problem is of as many patches
[[nodiscard]] ExchangeNetwork make_network(const FormFactors& factors, const HeatProblem& problem);

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

/// Given net flux of every condition, W/m²; 0 where it has none.
/// @param buried  N; have no flux
[[nodiscard]] std::vector<double> condition_fluxes(const FormFactors& factors, const HeatProblem& problem,
                                                   const std::vector<std::uint8_t>& buried);

/// @throws InputError where nothing holds the temperature of an enclosure, naming its groups
void refuse_singular(const FormFactors& factors, const HeatProblem& problem, const ExchangeNetwork& network,
                     const std::vector<std::uint8_t>& buried);

/// Progress of a linear solve, for the observer.
[[nodiscard]] ExchangeNetwork::Watcher heat_progress(Observer& observer, double tolerance);

} // namespace hemi
