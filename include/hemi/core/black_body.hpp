#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace hemi {

/// Stefan-Boltzmann constant, W/(m² K⁴). Source: CODATA 2018.
inline constexpr double stefan_boltzmann = 5.670374419e-8;

/// Second radiation constant h c / k, µm K. Source: CODATA 2018.
inline constexpr double second_radiation_constant = 14387.768775039337;

/// Exitance of a black body, sigma T⁴, W/m².
/// @param kelvin  temperature, at least 0
[[nodiscard]] constexpr double black_body_exitance(double kelvin) {
    return stefan_boltzmann * kelvin * kelvin * kelvin * kelvin;
}
/// The temperature in kelvin of a black body of that exitance, W/m²; 0 below 0.
[[nodiscard]] double black_body_temperature(double exitance);

/// Share of a black body's exitance below a wavelength, from 0 to 1, to about 15 digits.
/// Source: the series of J. S. Chang, J. E. Nelson, "Blackbody radiation fractional functions", 1973.
/// @param wavelength_temperature  wavelength times temperature, µm K, at least 0; may be infinite
[[nodiscard]] double black_body_fraction(double wavelength_temperature);

/// Share of a black body's exitance in each band; they sum to 1.
/// @param kelvin  temperature; at 0 K all of it is in the last band
/// @param limits  of the bands, µm, ascending: n limits make n + 1 bands from 0 to infinity
[[nodiscard]] std::vector<double> band_fractions(double kelvin, std::span<const double> limits);

/// A temperature in kelvin, from a number in kelvin or one with a unit behind it, K, C or °C: "293.15",
/// "20 C", "20°C". Nothing where the text is no such thing; the number may be below 0 K.
[[nodiscard]] std::optional<double> parse_temperature(std::string_view text);

} // namespace hemi
