#pragma once

#include "cli/report/text.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// Single factors, as `hemi factors` prints them.
namespace hemi::cli {

/// Prints a row of F, largest factors first.
void show_row(const FormFactors& factors, std::uint32_t index, const PatchNames& names, bool json);

/// Prints what leaves a surface element at a point, patch by patch, largest factors first.
/// @param at  position and normal
void show_point(const PatchMesh& mesh, const std::array<double, 6>& at, const PatchNames& names, bool json);

/// Factors between groups: a matrix while it fits a screen, else a line for every pair that see each other.
[[nodiscard]] std::string groups_table(const std::vector<std::string>& names, const GroupFactors& groups);

} // namespace hemi::cli
