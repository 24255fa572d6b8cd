#pragma once

#include "hemi/core/names.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace hemi {

/// Sets of settings for form factors by hemicubes, from quick to exact.
enum class Preset {
    plain,    ///< the textbook hemicube: one sample point a patch, texels alone
    fast,     ///< unoccluded factors times visibility, few texels
    standard, ///< the same with more sample points and shadow rays; the default
    exact,    ///< unoccluded factors to 1e-11, more of everything
};

/// Words of Preset.
template <>
struct Names<Preset> {
    /// Every value with its word.
    static constexpr NamedValue<Preset> table[] = {{Preset::plain, "plain"},
                                                   {Preset::fast, "fast"},
                                                   {Preset::standard, "default"},
                                                   {Preset::exact, "exact"}};
};

/// How form factors are found.
enum class Method {
    hemicube,   ///< hemicubes: the engine
    montecarlo, ///< baseline: rays from Sobol points in cosine-weighted directions
    contour,    ///< baseline: contour integrals, unoccluded
    direct,     ///< baseline: double area integration, unoccluded
    hemisphere, ///< baseline: the unit sphere (Nusselt)
};

/// Words of Method.
template <>
struct Names<Method> {
    /// Every value with its word.
    static constexpr NamedValue<Method> table[] = {{Method::hemicube, "hemicube"},
                                                   {Method::montecarlo, "montecarlo"},
                                                   {Method::contour, "contour"},
                                                   {Method::direct, "direct"},
                                                   {Method::hemisphere, "hemisphere"}};
};

/// How closely unoccluded factors are computed.
enum class ExchangeRule {
    standard, ///< factors to 1e-7, row sums to 1e-6; about 40 ns for a far pair, 1 to 20 us for near ones
    exact,    ///< factors to 1e-11, row sums to 1e-10; about 6 times slower
};

/// Words of ExchangeRule.
template <>
struct Names<ExchangeRule> {
    /// Every value with its word.
    static constexpr NamedValue<ExchangeRule> table[] = {{ExchangeRule::standard, "standard"},
                                                         {ExchangeRule::exact, "exact"}};
};

/// What made rows of form factors: enough to make the same ones again.
struct Provenance {
    Method method = Method::hemicube; ///< how the rows were found
    std::optional<Preset> preset =
        Preset::plain;                 ///< the settings below began with; none for baseline methods
    std::uint32_t resolution = 0;      ///< texels along a hemicube edge; 0 where it does not apply
    std::uint32_t eye_points = 1;      ///< sample points a patch
    std::uint32_t near_eye_points = 1; ///< up to so many where a surface is close
    std::uint32_t shadow_rays = 0;     ///< for each pair that is partly hidden
    ExchangeRule exchange_rule =
        ExchangeRule::standard; ///< of unoccluded factors, where rows have visibility
    std::uint64_t seed = 0;     ///< of the hemicubes' rotations
    std::string renderer;       ///< what computed the rows: GL_RENDERER
    std::string chosen_for;     ///< why the settings are what they are, where hemi chose them; else empty
};

} // namespace hemi
