#pragma once

#include "display/colour_scale.hpp"
#include "hemi/display/picture.hpp"
#include "viewer/viewer.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::viewer {

/// What the window shows of every patch.
enum class Quantity {
    picture, ///< light, as `hemi render` draws it
    outlines,
    items,
    radiosity,
    reflectance,
    exitance,
    row_error,
    estimated_error,
    factor_error, ///< the part of it that the form factors bring
    patch_size_error,
    row,    ///< F(i, j) of the picked patch i, at j
    column, ///< F(j, i), at j
};

struct QuantityName {
    Quantity quantity;
    const char* word;  ///< in scripts
    const char* title; ///< in the panel
};
/// All of them, in the panel's order.
[[nodiscard]] std::span<const QuantityName> quantity_names();
[[nodiscard]] std::optional<Quantity> quantity_by_word(std::string_view word);
[[nodiscard]] const char* quantity_title(Quantity quantity);

/// How the scene is shown; two equal ones give equal pictures.
struct Look {
    Quantity quantity = Quantity::picture;
    std::optional<std::uint32_t> channel; ///< of false colours; none: the mean over channels
    bool logarithmic = false;             ///< false colours of radiosity and exitance
    bool logarithmic_factors = true;      ///< false colours of form factors
    Shading shading = Shading::gouraud;
    ToneMapping tone_mapping = ToneMapping::filmic;
    double stops = 0.0; ///< exposure over the one at the start, powers of two
    bool outlines = false;
    bool backs = false;

    bool operator==(const Look&) const = default;
};

/// The light in the scene as it stands: N·channels each, as RadiosityProblem has them.
struct Light {
    std::vector<double> reflectance;
    std::vector<double> exitance;
    std::vector<double> radiosity;
    std::vector<float> vertices;     ///< as Solution::vertex_radiosity; empty: means over the patches
    std::vector<std::uint8_t> known; ///< whether a patch's radiosity is more than a beginning, N; empty: all

    [[nodiscard]] bool knows(std::uint32_t patch) const { return known.empty() || known[patch] != 0; }
};

/// One value a patch, NaN where there is none, and the scale that it is shown by.
struct Field {
    std::string title;
    std::string unit;
    std::vector<double> values;
    ColourScale scale;
    const char* grey = "0"; ///< what it means that there is none
};

/// Why a quantity cannot be shown of this input; null if it can.
[[nodiscard]] const char* why_not(Quantity quantity, const ViewerInput& input,
                                  std::optional<std::uint32_t> picked);

/// The field that `look` shows; nothing for what is no field: the picture, outlines, items.
/// @param usual_factor  scales of rows and columns end there, whichever patch is picked
[[nodiscard]] std::optional<Field> make_field(const Look& look, const ViewerInput& input, const Light& light,
                                              std::optional<std::uint32_t> picked, double usual_factor);
/// Median over the rows of their largest factor: few are far above it, where patches touch.
[[nodiscard]] double usual_largest_factor(const FormFactorMatrix& factors);

[[nodiscard]] std::vector<std::array<float, 3>> item_colours(const PatchMesh& mesh);

/// Radiosity of every patch of `mesh` as the picture shows it in its flat shading; display linear.
[[nodiscard]] std::vector<std::array<float, 3>> light_colours(const PictureMesh& mesh, double exposure,
                                                              ToneMapping tone_mapping);

/// F(i, j) of a row or F(j, i) of a column at j; 0 where nothing is stored.
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
