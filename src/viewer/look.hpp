#pragma once

#include "display/colour_scale.hpp"
#include "hemi/display/colour_map.hpp"
#include "hemi/display/false_colours.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/pipeline/quantities.hpp"
#include "viewer/viewer.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::viewer {

/// What the window shows.
enum class View {
    picture, ///< light, as `hemi render` draws it
    outlines,
    items,
    groups,   ///< every group in a colour of its own
    findings, ///< what `hemi check` finds
    quantity, ///< what is known of every patch, as `hemi render --show` draws it
    row,      ///< F(i, j) of the picked patch i, at j
    column,   ///< F(j, i), at j
};

/// One of the things that the window shows.
struct Shown {
    View view = View::picture;
    Quantity quantity = Quantity::radiosity; ///< of View::quantity; as it is here of the others

    bool operator==(const Shown&) const = default;
};

struct ShownName {
    Shown shown;
    std::string_view word; ///< in scripts
    const char* title;     ///< in the panel
};
/// All of them, in the panel's order.
[[nodiscard]] std::span<const ShownName> shown_names();
[[nodiscard]] std::optional<Shown> shown_by_word(std::string_view word);
[[nodiscard]] const ShownName& name_of(const Shown& shown);

/// How the scene is shown; two equal ones give equal pictures.
struct Look {
    Shown shown;
    std::string channel = "mean";                    ///< of quantities, as patch_quantity() takes it
    ColourMap map = ColourMap::viridis;              ///< of false colours
    std::optional<std::array<double, 2>> range;      ///< of quantities' scales; none: as values ask for
    bool logarithmic = false;                        ///< false colours of quantities
    bool logarithmic_factors = true;                 ///< false colours of form factors
    std::uint32_t bands = 0;                         ///< of false colours; 0: they run smoothly
    bool iso_lines = false;                          ///< of false colours
    bool celsius = false;                            ///< temperatures in °C, else in K
    bool difference = false;                         ///< quantities less those that they are compared with
    ColourMap difference_map = ColourMap::cool_warm; ///< of differences
    Shading shading = Shading::gouraud;
    ToneMapping tone_mapping = ToneMapping::filmic;
    double stops = 0.0; ///< exposure over the one at the start, powers of two
    bool outlines = false;
    bool backs = false;
    bool dots = true;                       ///< points are shown, where there are any
    std::optional<std::size_t> dots_column; ///< of the points; none: they are white

    bool operator==(const Look&) const = default;
};

/// Whether what is shown is a difference of two solutions.
[[nodiscard]] bool shows_difference(const Look& look);
/// The colours of what is shown.
[[nodiscard]] ColourMap& map_of(Look& look);

/// The light in the scene as it stands: N·channels each, as RadiosityProblem has them.
struct Light {
    std::vector<double> reflectance;
    std::vector<double> exitance;
    std::vector<double> radiosity;
    std::vector<float> vertices;     ///< as Solution::vertex_radiosity; empty: means over the patches
    std::vector<std::uint8_t> known; ///< whether a patch's radiosity is more than a beginning, N; empty: all
    std::vector<HeatCondition> conditions{}; ///< as HeatProblem::conditions; empty: those of the scene
    std::vector<double> environment{};       ///< as RadiosityProblem::environment

    [[nodiscard]] bool knows(std::uint32_t patch) const { return known.empty() || known[patch] != 0; }
};

/// One value a patch, and the scale that it is shown by.
struct Field {
    FalseColours shown;
    ColourScale scale;
    const char* grey = "not known"; ///< what it means that there is none
};

/// Why something cannot be shown of this input; null if it can.
[[nodiscard]] const char* why_not(const Shown& shown, const ViewerInput& input,
                                  std::optional<std::uint32_t> picked);
/// Why no difference to what is compared can be shown of it; null if it can.
[[nodiscard]] const char* why_no_difference(const Shown& shown, const ViewerInput& input);

/// Channels that quantities may be of: the mean, the sum, the luminance where there is one, and each.
[[nodiscard]] std::vector<std::string> channel_choices(const std::vector<std::string>& channels);

/// The scene and its light as they stand.
struct Lit {
    Scene scene;
    Solution solution;
};
/// A quantity of patches, or by how much it differs.
/// @param light     says of which patches the radiosity is known
/// @param compared  what it is compared with; may be null where no difference is shown
[[nodiscard]] Field quantity_field(const Look& look, const PatchMesh& mesh, const Lit& lit,
                                   const Light& light, const Compared* compared);
/// A row or a column of form factors.
/// @param usual_factor  scales end there, whichever patch is picked
[[nodiscard]] Field factor_field(const Look& look, const FormFactorMatrix& factors, std::uint32_t picked,
                                 double usual_factor);
/// Median over the rows of their largest factor: few are far above it, where patches touch.
[[nodiscard]] double usual_largest_factor(const FormFactorMatrix& factors);

[[nodiscard]] std::vector<std::array<float, 3>> item_colours(const PatchMesh& mesh);
/// As many colours as there are groups.
[[nodiscard]] std::vector<std::array<float, 3>> group_colours(const PatchMesh& mesh);

/// Radiosity of every patch of `mesh` as the picture shows it in its flat shading; display linear.
[[nodiscard]] std::vector<std::array<float, 3>> light_colours(const PictureMesh& mesh, double exposure,
                                                              ToneMapping tone_mapping);

/// F(i, j) of a row or F(j, i) of a column at j; 0 where nothing is stored. What goes to a cluster is shared
/// out among its patches by area.
[[nodiscard]] std::vector<double> factors_from(const FormFactorMatrix& factors, std::uint32_t patch);
[[nodiscard]] std::vector<double> factors_to(const FormFactorMatrix& factors, std::uint32_t patch);

/// How a picture is drawn: false colours are not lit, exposed or tone-mapped.
/// @param first  what the look does not say
[[nodiscard]] PictureSettings picture_settings(const Look& look, const PictureSettings& first,
                                               double exposure, std::array<std::uint32_t, 2> size);
/// `picture` with dim greys where the light is not known, which look the same at any exposure.
[[nodiscard]] PictureMesh with_unknown_grey(PictureMesh picture, const PatchMesh& mesh, const Light& light,
                                            double exposure);

} // namespace hemi::viewer
