#pragma once

#include "viewer/look.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi::viewer {

struct Choices;

/// How much area has which value: shares of the area that has one, of equal steps of the scale from its low
/// end to its high one. What lies beyond is in none.
/// @param count  of the steps
[[nodiscard]] std::vector<double> area_histogram(const Field& field, const PatchMesh& mesh,
                                                 std::size_t count);

/// The colours of a field with their values and the histogram over them, in the lower left of the view. A
/// drag over it chooses the range, a double click gives it back; one on its title moves it. Between
/// Gui::begin() and Gui::end().
/// @param histogram  of the field
/// @param choices    get the range, where what is shown can have one
void legend_window(const Field& field, const std::vector<double>& histogram,
                   std::array<std::uint32_t, 2> view, Choices& choices);
/// The colours of dots, without a histogram, in the lower left.
/// @param above_other  whether that of a field is there
void dots_legend_window(const Field& field, std::array<std::uint32_t, 2> view, bool above_other);

} // namespace hemi::viewer
