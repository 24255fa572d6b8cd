#pragma once

#include "cli/loaded_scene.hpp"
#include "cli/report/report.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factors.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// Single factors, as `hemi factors` shows them.
namespace hemi::cli {

/// A row of F, largest factors first.
[[nodiscard]] Report row_report(const FormFactors& factors, std::uint32_t index, const PatchNames& names);

/// What leaves a surface element at a point, patch by patch, largest factors first.
/// @param at  position and normal
[[nodiscard]] Report point_report(const LoadedScene& loaded, const std::array<double, 6>& at);

/// Factors between groups: a matrix while it fits a screen, else a line for every pair that see each other.
/// Not a Report, as there may be millions of pairs: only the form that is wanted is made.
[[nodiscard]] std::string group_factors_text(const std::vector<std::string>& names,
                                             const GroupFactors& groups);
/// The same as a matrix, and the groups' areas and shares to the environment and back faces.
[[nodiscard]] Json group_factors_json(const std::vector<std::string>& names, const GroupFactors& groups);

} // namespace hemi::cli
