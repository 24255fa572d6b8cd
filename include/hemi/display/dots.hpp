#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/display/false_colours.hpp"
#include "hemi/display/picture.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

/// Points, and what is known of them.
struct PointTable {
    /// One value a point.
    struct Column {
        std::string name;           ///< as a table has it
        std::string unit;           ///< empty: none, or it is not known
        std::vector<double> values; ///< not a number where there is none
    };
    std::vector<Vec3> positions; ///< scene units
    std::vector<Column> columns; ///< may be none
};

/// Points in the picture of a scene: small balls that surfaces hide, of one colour each.
struct Dots {
    std::vector<Vec3> positions; ///< scene units
    FalseColours shown;          ///< a value a point; without any they are white, and there is no legend
    double radius = 0.0;         ///< of a ball, scene units
};
/// Dots in the colours of a column.
/// @param table   the points
/// @param column  index; none: white ones
/// @param scene   the balls' size is a small share of its diagonal, less where they are close together
/// @throws InvalidArgument for a column that is not there, and infinite values
[[nodiscard]] Dots make_dots(const PointTable& table, std::optional<std::size_t> column, const Bounds& scene);

/// Puts dots into what a picture is drawn of, behind the patches, without outlines. Their colours are those
/// of the scale whatever the exposure; those without a value are grey.
/// @param mesh      of the scene
/// @param dots      are put into it
/// @param settings  exposure, tone mapping and backs, as it will be drawn with them
[[nodiscard]] PictureMesh with_dots(PictureMesh mesh, const Dots& dots, const PictureSettings& settings);

/// Draws the dots' legend into the lower left of `srgb`, as draw_false_colours() does it.
/// @param picture  is drawn into
/// @param dots     as they are in it
/// @param below    legends that it stands above
/// @return whether there was room, and something to tell
bool draw_dots_legend(Picture& picture, const Dots& dots, std::uint32_t below = 0);

} // namespace hemi
