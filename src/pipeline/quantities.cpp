#include "hemi/pipeline/quantities.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/scene/light_unit.hpp"
#include "hemi/scene/thermal_exitance.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// How much of every channel is in the one value.
std::vector<double> channel_weights(const std::vector<std::string>& channels, const std::string& wanted) {
    std::vector<double> weights(channels.size(), 0.0);
    if (const auto named = std::find(channels.begin(), channels.end(), wanted); named != channels.end()) {
        weights[static_cast<std::size_t>(named - channels.begin())] = 1.0;
        return weights;
    }
    if (wanted == "mean" || wanted == "sum") {
        std::fill(weights.begin(), weights.end(),
                  wanted == "sum" ? 1.0 : 1.0 / static_cast<double>(channels.size()));
        return weights;
    }
    if (wanted == "luminance") {
        weights = luminance_weights(channels);
        if (weights.empty()) {
            throw InvalidArgument(
                fmt::format("luminance needs channels red, green and blue; the scene has {}",
                            fmt::join(channels, ", ")),
                {"channel"});
        }
        return weights;
    }
    std::vector<std::string> known = channels;
    known.insert(known.end(), {"mean", "sum", "luminance"});
    throw InvalidArgument(fmt::format("there is no channel '{}' among {}, mean, sum and luminance{}", wanted,
                                      fmt::join(channels, ", "), did_you_mean(wanted, known)),
                          {"channel"});
}

std::vector<double> one_value(std::span<const double> values, const std::vector<double>& weights) {
    std::vector<double> result(values.size() / weights.size(), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) {
        result[k / weights.size()] += weights[k % weights.size()] * values[k];
    }
    return result;
}

/// Errors of channels are not told apart by sign: the root of the sum of squares.
std::vector<double> one_error(std::span<const double> values, const std::vector<double>& weights) {
    std::vector<double> result(values.size() / weights.size(), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) {
        result[k / weights.size()] += std::pow(weights[k % weights.size()] * values[k], 2.0);
    }
    for (double& value : result) {
        value = std::sqrt(value);
    }
    return result;
}

[[noreturn]] void missing(const char* what, const char* why) {
    throw InvalidArgument(fmt::format("{}: {}", what, why), {"show"});
}

/// Lamps outshine all else: the scale is that of what they light.
std::optional<std::array<double, 2>> range_of_lit(const std::vector<double>& radiosity,
                                                  const std::vector<double>& exitance) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double brightest = -low;
    for (std::size_t i = 0; i < radiosity.size(); ++i) {
        if (exitance[i] > 0.0) {
            brightest = std::max(brightest, radiosity[i]);
        } else if (!std::isnan(radiosity[i])) {
            low = std::min(low, radiosity[i]);
            high = std::max(high, radiosity[i]);
        }
    }
    return low < high && brightest > high ? std::optional(std::array{low, high}) : std::nullopt;
}

/// About values that differ by no more than a solver leaves, which would else be shown as if it were more.
std::optional<std::array<double, 2>> range_about_one(const std::vector<double>& values) {
    constexpr double same = 1e-4;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double value : values) {
        low = std::isnan(value) ? low : std::min(low, value);
        high = std::isnan(value) ? high : std::max(high, value);
    }
    return low > 0.0 && high - low <= same * high ? std::optional(std::array{0.99 * low, 1.01 * high})
                                                  : std::nullopt;
}

} // namespace

const char* title_of(Quantity quantity) {
    switch (quantity) {
    case Quantity::radiosity:
        return "Radiosity";
    case Quantity::irradiance:
        return "Irradiance";
    case Quantity::direct:
        return "Direct irradiance";
    case Quantity::exitance:
        return "Exitance";
    case Quantity::reflectance:
        return "Reflectance";
    case Quantity::emissivity:
        return "Emissivity";
    case Quantity::environment:
        return "Share of the environment";
    case Quantity::blocked:
        return "Share of backs";
    case Quantity::row_error:
        return "Row sum less 1";
    case Quantity::error:
        return "Estimated error of the radiosity";
    case Quantity::error_factors:
        return "Error by form factors";
    case Quantity::error_patch_size:
        return "Error by patch size";
    case Quantity::area:
        return "Area";
    case Quantity::temperature:
        return "Temperature";
    case Quantity::net_flux:
        return "Net flux";
    }
    return "";
}

bool needs_all_rows(Quantity quantity) {
    return quantity == Quantity::irradiance || quantity == Quantity::environment ||
           quantity == Quantity::blocked || quantity == Quantity::row_error;
}

bool is_error(Quantity quantity) {
    return quantity == Quantity::error || quantity == Quantity::error_factors ||
           quantity == Quantity::error_patch_size;
}

bool is_of_heat(Quantity quantity) {
    return quantity == Quantity::temperature || quantity == Quantity::net_flux;
}

void show_in_celsius(FalseColours& shown) {
    constexpr double zero_celsius = 273.15;
    if (shown.unit != "K") {
        return;
    }
    shown.unit = "°C";
    for (double& value : shown.values) {
        value -= zero_celsius;
    }
}

void check_channel(const std::vector<std::string>& channels, const std::string& channel) {
    (void)channel_weights(channels, channel);
}

FalseColours patch_quantity(Quantity quantity, const Scene& scene, const PatchMesh& mesh,
                            const Solution& solution, const std::string& channel) {
    const std::vector<double> weights = channel_weights(scene.channels, channel);
    const std::size_t values = std::size_t{mesh.size()} * weights.size();
    if (solution.radiosity.size() != values || solution.exitance.size() != values) {
        throw InvalidArgument("a quantity of patches: the solution belongs to another mesh");
    }
    const std::string of = scene.channels.size() == 1 ? "" : ", " + channel;
    const std::string flux = flux_density_unit(scene);
    const std::string title = title_of(quantity);
    FalseColours shown;
    const auto shares = [&](const std::vector<double>& share) {
        if (share.size() != mesh.size()) {
            missing(title.c_str(), "is not stored with this solution");
        }
        shown = {share, title, ""};
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            if (solution.row_sum[i] + solution.environment_share[i] + solution.back_face_share[i] == 0.0) {
                shown.values[i] = none;
            }
        }
    };
    switch (quantity) {
    case Quantity::radiosity:
        shown = {one_value(solution.radiosity, weights), title + of, flux};
        break;
    case Quantity::irradiance:
        if (solution.irradiance.size() != values) {
            missing("irradiance", "is not known; `solve --result` stores it");
        }
        shown = {one_value(solution.irradiance, weights), title + of, irradiance_unit(scene)};
        break;
    case Quantity::direct:
        if (solution.direct.size() != values) {
            missing("direct irradiance", "there is neither sun nor sky");
        }
        shown = {one_value(solution.direct, weights), title + of, irradiance_unit(scene)};
        break;
    case Quantity::exitance:
        shown = {one_value(solution.exitance, weights), title + of, flux};
        break;
    case Quantity::reflectance:
    case Quantity::emissivity:
        shown = {one_value(reflectances_at(mesh, scene.materials, solution.temperature), weights), title + of,
                 ""};
        for (double& value : shown.values) {
            value = quantity == Quantity::emissivity ? 1.0 - value : value;
        }
        break;
    case Quantity::environment:
        shares(solution.environment_share);
        break;
    case Quantity::blocked:
        shares(solution.back_face_share);
        break;
    case Quantity::row_error:
        shares(solution.row_sum);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            shown.values[i] += solution.environment_share[i] + solution.back_face_share[i] - 1.0;
        }
        break;
    case Quantity::error:
        shown = {one_error(radiosity_errors(solution), weights), title + of, flux};
        break;
    case Quantity::error_factors:
        shown = {one_error(solution.error ? solution.error->patches : std::vector<double>(), weights),
                 title + of, flux};
        break;
    case Quantity::error_patch_size:
        shown = {
            one_error(solution.patch_size_error ? solution.patch_size_error->patches : std::vector<double>(),
                      weights),
            title + of, flux};
        break;
    case Quantity::area:
        shown = {{mesh.areas().begin(), mesh.areas().end()}, title, "m²"};
        for (double& value : shown.values) {
            value *= std::pow(scene.unit.value_or(1.0), 2.0);
        }
        break;
    case Quantity::temperature:
    case Quantity::net_flux:
        shown = quantity == Quantity::temperature ? FalseColours{solution.temperature, title, "K"}
                                                  : FalseColours{solution.net_flux, title, "W/m²"};
        if (shown.values.size() != mesh.size()) {
            missing(std::string(to_word(quantity)).c_str(), "`hemi heat` finds it");
        }
        break;
    }
    if (shown.values.size() != mesh.size()) {
        missing("error", "was not estimated");
    }
    const bool covers = !solution.back_face_share.empty() && !is_of_heat(quantity);
    for (std::uint32_t i = 0; i < mesh.size() && covers; ++i) {
        if (solution.back_face_share[i] > buried_above && quantity != Quantity::blocked) {
            shown.values[i] = none;
        }
    }
    // What arrives runs on where the material changes; what is reflected of it does not.
    shown.across_materials =
        quantity == Quantity::irradiance || quantity == Quantity::direct || quantity == Quantity::environment;
    if (quantity == Quantity::radiosity || quantity == Quantity::irradiance) {
        shown.range = range_about_one(shown.values);
    }
    if (quantity == Quantity::radiosity && !shown.range) {
        shown.range = range_of_lit(shown.values, one_value(solution.exitance, weights));
    }
    return shown;
}

} // namespace hemi
