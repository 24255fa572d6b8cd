#pragma once

#include "hemi/display/picture_cut.hpp"
#include "viewer/document.hpp"
#include "viewer/shown_values.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hemi::viewer {

struct Choices;
struct PanelContent;

/// What the panel says of a group; not a number where there is nothing to say.
struct GroupLine {
    double area;      ///< m²
    double mean;      ///< of what is shown, weighted with area
    double net_power; ///< W, leaving positive
};

/// Of all groups, in the mesh's order.
struct GroupTable {
    std::string quantity; ///< that the means are of
    std::string unit;
    std::vector<GroupLine> lines;
};

/// @param values  that the means are of
[[nodiscard]] GroupTable group_table(const Document& document, const ShownValues& values);

/// Edges of a group's surfaces, or of the box around them where they are many.
[[nodiscard]] std::vector<std::array<Vec3, 2>> group_edges(const PatchMesh& mesh, std::uint32_t group);

/// Selects a group as a click on one of its patches does; a patch of another one is let go of.
void select_group(Choices& choices, std::uint32_t group, const PatchMesh& mesh);
/// Shows one group alone.
/// @param count  of all groups
void isolate(Choices& choices, std::uint32_t group, std::size_t count);
/// @param count  of all groups
void set_visibility(Choices& choices, std::uint32_t group, Visibility visibility, std::size_t count);

/// The choices of groups again, of a scene whose groups are others: by their names.
/// @param before  of the scene before
/// @param now     of this one
void choose_groups_again(Choices& choices, const std::vector<std::string>& before,
                         const std::vector<std::string>& now);

/// The list of groups: a click selects one, a square before its name says how much of it is shown.
void groups_section(const PanelContent& content, Choices& choices);

} // namespace hemi::viewer
