#include "viewer/look.hpp"

#include "display/painted.hpp"
#include "hemi/scene/light_unit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi::viewer {

namespace {

constexpr std::array<QuantityName, 12> names{
    {{Quantity::picture, "picture", "Light"},
     {Quantity::outlines, "outlines", "Patch wireframe"},
     {Quantity::items, "items", "Item ids"},
     {Quantity::radiosity, "radiosity", "Radiosity, false colour"},
     {Quantity::reflectance, "reflectance", "Reflectance"},
     {Quantity::exitance, "exitance", "Exitance"},
     {Quantity::row_error, "row-error", "Form factors: row-sum error"},
     {Quantity::estimated_error, "error", "Radiosity: estimated error"},
     {Quantity::factor_error, "error-factors", "Estimated error: form factors"},
     {Quantity::patch_size_error, "error-patch-size", "Estimated error: patch size"},
     {Quantity::row, "row", "Picked patch: row of F"},
     {Quantity::column, "column", "Picked patch: column of F"}}};

constexpr double none = std::numeric_limits<double>::quiet_NaN();
/// Logarithmic scales span so much.
constexpr double radiosity_range = 1e-3;
constexpr double factor_range = 1e-4;

/// One channel of N·channels, or the mean over them.
std::vector<double> one_channel(std::span<const double> values, std::uint32_t channels,
                                std::optional<std::uint32_t> channel) {
    std::vector<double> result(values.size() / channels);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const auto of_patch = values.subspan(i * channels, channels);
        if (channel) {
            result[i] = of_patch[*channel];
            continue;
        }
        for (const double value : of_patch) {
            result[i] += value / channels;
        }
    }
    return result;
}

double largest(std::span<const double> values) {
    double result = 0.0;
    for (const double value : values) {
        result = value > result ? value : result;
    }
    return result;
}

ColourScale scale_to(double high, bool logarithmic, double range) {
    const double top = high > 0.0 ? round_up(high) : 1.0;
    return {logarithmic ? top * range : 0.0, top, logarithmic};
}

/// Lamps and the spots of light beside them outshine all else: the scale ends where nearly all surfaces
/// without exitance do.
double most_reflected(const std::vector<double>& radiosity, const std::vector<double>& exitance) {
    std::vector<double> reflected;
    for (std::size_t i = 0; i < radiosity.size(); ++i) {
        if (!(exitance[i] > 0.0)) {
            reflected.push_back(radiosity[i]);
        }
    }
    if (reflected.empty()) {
        return largest(radiosity);
    }
    const std::size_t place = (reflected.size() - 1) * 98 / 100;
    std::nth_element(reflected.begin(), reflected.begin() + static_cast<std::ptrdiff_t>(place),
                     reflected.end());
    return reflected[place] > 0.0 ? reflected[place] : largest(reflected);
}

std::string channel_text(const ViewerInput& input, const Look& look) {
    if (input.channels() == 1) {
        return "";
    }
    return look.channel ? ", " + input.scene->channels[*look.channel] : ", mean of channels";
}

/// Estimated errors of the patches, and what they are called.
struct Error {
    std::string title;
    std::vector<double> values;
};
std::optional<Error> error_of(Quantity quantity, const Solution& solution) {
    switch (quantity) {
    case Quantity::estimated_error:
        return Error{solution.patch_size_error ? "Estimated error" : "Error from form factors alone",
                     radiosity_errors(solution)};
    case Quantity::factor_error:
        return Error{"Error from form factors", solution.error->patches};
    case Quantity::patch_size_error:
        return Error{"Error from patch size", solution.patch_size_error->patches};
    default:
        return std::nullopt;
    }
}

Field light_field(const Look& look, const ViewerInput& input, const Light& light) {
    const auto take = [&](const std::vector<double>& values) {
        return one_channel(values, input.channels(), look.channel);
    };
    const std::string channel = channel_text(input, look);
    const std::string unit = flux_density_unit(*input.scene);
    if (look.quantity == Quantity::reflectance) {
        return {"Reflectance" + channel, "", take(light.reflectance), {0.0, 1.0, false}};
    }
    if (look.quantity == Quantity::exitance) {
        Field field{"Exitance" + channel, unit, take(light.exitance), {}};
        field.scale = scale_to(largest(field.values), look.logarithmic, radiosity_range);
        return field;
    }
    if (const std::optional<Error> error = error_of(look.quantity, input.solution)) {
        Field field{error->title + channel, unit, take(error->values), {}};
        field.scale = scale_to(largest(field.values), look.logarithmic, radiosity_range);
        return field;
    }
    Field field{"Radiosity" + channel, unit, take(light.radiosity), {}, "not known"};
    field.scale =
        scale_to(most_reflected(field.values, take(light.exitance)), look.logarithmic, radiosity_range);
    for (std::uint32_t i = 0; i < field.values.size(); ++i) {
        field.values[i] = light.knows(i) ? field.values[i] : none;
    }
    return field;
}

Field row_error_field(const ViewerInput& input) {
    Field field{"Row of F: |sum + e + b - 1|", "", {}, {1e-8, 1e-2, true}};
    for (std::size_t i = 0; i < input.solution.row_sum.size(); ++i) {
        field.values.push_back(std::abs(input.solution.row_sum[i] + input.solution.environment_share[i] +
                                        input.solution.back_face_share[i] - 1.0));
    }
    return field;
}

} // namespace

std::span<const QuantityName> quantity_names() {
    return names;
}

std::optional<Quantity> quantity_by_word(std::string_view word) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [word](const QuantityName& name) { return name.word == word; });
    return found == names.end() ? std::nullopt : std::optional(found->quantity);
}

const char* quantity_title(Quantity quantity) {
    return std::find_if(names.begin(), names.end(),
                        [quantity](const QuantityName& name) { return name.quantity == quantity; })
        ->title;
}

const char* why_not(Quantity quantity, const ViewerInput& input, std::optional<std::uint32_t> picked) {
    const bool of_factors = quantity == Quantity::estimated_error || quantity == Quantity::factor_error;
    if (of_factors && !input.solution.error) {
        return "no errors were estimated of this light";
    }
    if (quantity == Quantity::patch_size_error && !input.solution.patch_size_error) {
        return "estimated by `hemi solve`: open its result";
    }
    if (quantity == Quantity::row_error && input.solution.row_sum.empty()) {
        return "needs form factors";
    }
    if (quantity == Quantity::row || quantity == Quantity::column) {
        if (input.factors == nullptr) {
            return input.factor_settings ? "not computed"
                                         : "a stored solution has no form factors; open the scene instead";
        }
        if (!picked) {
            return "click a patch first";
        }
    }
    return nullptr;
}

double usual_largest_factor(const FormFactorMatrix& factors) {
    std::vector<double> of_rows;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        const auto found = std::max_element(row.values.begin(), row.values.end());
        if (found != row.values.end()) {
            of_rows.push_back(static_cast<double>(*found));
        }
    }
    if (of_rows.empty()) {
        return 0.0;
    }
    const auto middle = of_rows.begin() + static_cast<std::ptrdiff_t>(of_rows.size() / 2);
    std::nth_element(of_rows.begin(), middle, of_rows.end());
    return *middle;
}

std::vector<double> factors_from(const FormFactorMatrix& factors, std::uint32_t patch) {
    std::vector<double> result(factors.size(), 0.0);
    const RowView row = factors.row(patch);
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        result[row.columns[k]] = static_cast<double>(row.values[k]);
    }
    return result;
}

std::vector<double> factors_to(const FormFactorMatrix& factors, std::uint32_t patch) {
    std::vector<double> result(factors.size(), 0.0);
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        const RowView row = factors.row(j);
        const auto found = std::lower_bound(row.columns.begin(), row.columns.end(), patch);
        if (found != row.columns.end() && *found == patch) {
            result[j] =
                static_cast<double>(row.values[static_cast<std::size_t>(found - row.columns.begin())]);
        }
    }
    return result;
}

std::optional<Field> make_field(const Look& look, const ViewerInput& input, const Light& light,
                                std::optional<std::uint32_t> picked, double usual_factor) {
    switch (look.quantity) {
    case Quantity::picture:
    case Quantity::outlines:
    case Quantity::items:
        return std::nullopt;
    case Quantity::row_error:
        return row_error_field(input);
    case Quantity::row:
    case Quantity::column: {
        const bool row = look.quantity == Quantity::row;
        Field field{
            row ? "F(i, j), i picked: leaves i, arrives at j" : "F(j, i), i picked: leaves j, arrives at i",
            "",
            row ? factors_from(input.factors->matrix, *picked) : factors_to(input.factors->matrix, *picked),
            scale_to(usual_factor, look.logarithmic_factors, factor_range)};
        std::replace(field.values.begin(), field.values.end(), 0.0, none);
        return field;
    }
    case Quantity::radiosity:
    case Quantity::reflectance:
    case Quantity::exitance:
    case Quantity::estimated_error:
    case Quantity::factor_error:
    case Quantity::patch_size_error:
        break;
    }
    return light_field(look, input, light);
}

std::vector<std::array<float, 3>> item_colours(const PatchMesh& mesh) {
    std::vector<std::array<float, 3>> colours;
    colours.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        colours.push_back(item_colour(i));
    }
    return colours;
}

std::vector<std::array<float, 3>> light_colours(const PictureMesh& mesh, double exposure,
                                                ToneMapping tone_mapping) {
    std::vector<std::array<float, 3>> colours(mesh.patches.size() / 3);
    for (std::size_t i = 0; i < colours.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            // As resolve.frag does it.
            const auto x = static_cast<float>(
                std::clamp(static_cast<double>(mesh.patches[i * 3 + c]) * exposure, 0.0, 1e6));
            const float filmic = x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F);
            colours[i][c] = std::clamp(tone_mapping == ToneMapping::filmic ? filmic : x, 0.0F, 1.0F);
        }
    }
    return colours;
}

PictureSettings picture_settings(const Look& look, const PictureSettings& first, double exposure,
                                 std::array<std::uint32_t, 2> size) {
    PictureSettings settings = first;
    settings.width = std::max(size[0], 1U);
    settings.height = std::max(size[1], 1U);
    settings.shading = look.shading;
    settings.tone_mapping = look.tone_mapping;
    settings.exposure = exposure;
    settings.outlines = look.outlines;
    settings.backs = look.backs;
    if (look.quantity != Quantity::picture) {
        settings.shading = Shading::flat;
        settings.tone_mapping = ToneMapping::linear;
        settings.exposure = 1.0;
        settings.outlines = look.outlines || look.quantity == Quantity::outlines;
    }
    return settings;
}

PictureMesh with_unknown_grey(PictureMesh picture, const PatchMesh& mesh, const Light& light,
                              double exposure) {
    constexpr double dim = 0.25;
    if (light.known.empty() || !(exposure > 0.0)) {
        return picture;
    }
    const auto greys = plain_colours(mesh);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (light.knows(i)) {
            continue;
        }
        const auto value = static_cast<float>(dim * static_cast<double>(greys[i][0]) / exposure);
        std::fill_n(picture.patches.begin() + std::ptrdiff_t{i} * 3, 3, value);
        std::fill_n(picture.corners.begin() + std::ptrdiff_t{i} * 12, 12, value);
    }
    return picture;
}

} // namespace hemi::viewer
