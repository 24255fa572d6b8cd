#include "hemi/pipeline/light_balance.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/product.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

std::optional<LightBalance> light_balance(const FormFactors& factors, const PatchValues& values,
                                          std::span<const double> radiosity,
                                          std::span<const double> weights) {
    const std::uint32_t patches = factors.matrix.size();
    const std::size_t channels = values.channels;
    const std::size_t count = patches * channels;
    if (radiosity.size() != count || values.reflectance.size() != count || values.exitance.size() != count ||
        (!values.environment.empty() && values.environment.size() != channels) ||
        (!values.direct.empty() && values.direct.size() != count) ||
        (!weights.empty() && weights.size() != channels)) {
        throw InvalidArgument(fmt::format("balance: {} values for {} patches of {} channels",
                                          radiosity.size(), patches, channels));
    }
    const auto shines = [](double value) { return value > 0.0; };
    const bool is_lit_from_outside =
        std::any_of(values.environment.begin(), values.environment.end(), shines) ||
        std::any_of(values.direct.begin(), values.direct.end(), shines);
    std::vector<double> absorbing(count);
    std::transform(values.reflectance.begin(), values.reflectance.end(), absorbing.begin(),
                   [](double reflectance) { return 1.0 - reflectance; });
    std::vector<double> absorbed_share(count); // of what leaves each patch
    multiply(factors.matrix, absorbing, values.channels, absorbed_share);
    LightBalance balance;
    balance.lost_of_group.resize(factors.groups.size(), 0.0);
    for (std::uint32_t i = 0; i < patches; ++i) {
        const double area = factors.areas[i];
        const double environment = factors.matrix.environment(i);
        const double blocked = factors.matrix.blocked(i);
        for (std::size_t c = 0; c < channels; ++c) {
            const std::size_t at = i * channels + c;
            if (!factors.matrix.known(i) && (radiosity[at] > 0.0 || is_lit_from_outside)) {
                return std::nullopt;
            }
            const double counted = weights.empty() ? area : weights[c] * area;
            const double leaving = counted * radiosity[at];
            const double coming =
                counted * ((values.environment.empty() ? 0.0 : environment * values.environment[c]) +
                           (values.direct.empty() ? 0.0 : values.direct[at]));
            balance.emitted += counted * values.exitance[at];
            balance.incoming += counted * values.exitance[at] + coming;
            balance.absorbed += leaving * absorbed_share[at] + coming * absorbing[at];
            balance.environment += leaving * environment - coming;
            balance.lost += leaving * blocked;
            balance.lost_of_group[factors.group_of[i]] += leaving * blocked;
        }
    }
    return balance;
}

std::vector<std::uint32_t> shining_patches(const PatchValues& values) {
    const std::size_t patches = values.reflectance.size() / values.channels;
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < patches; ++i) {
        bool shines = false;
        for (std::size_t at = i * values.channels; at < (i + 1) * values.channels; ++at) {
            shines = shines || values.reflectance[at] > 0.0 || values.exitance[at] > 0.0;
        }
        if (shines) {
            result.push_back(static_cast<std::uint32_t>(i));
        }
    }
    return result;
}

} // namespace hemi
