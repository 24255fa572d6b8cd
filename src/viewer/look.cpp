#include "viewer/look.hpp"

#include "display/false_colour_scale.hpp"
#include "display/painted.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/matrix/source_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi::viewer {

namespace {

/// The window's own before and after the quantities.
std::vector<ShownName> all_names() {
    std::vector<ShownName> names{{{View::picture}, "picture", "Light"},
                                 {{View::outlines}, "outlines", "Patch wireframe"},
                                 {{View::items}, "items", "Item ids"},
                                 {{View::groups}, "groups", "Groups"},
                                 {{View::findings}, "findings", "What check finds"}};
    for (const NamedValue<Quantity>& known : Names<Quantity>::table) {
        names.push_back({{View::quantity, known.value}, known.word, title_of(known.value)});
    }
    names.push_back({{View::row}, "row", "Picked patch: row of F"});
    names.push_back({{View::column}, "column", "Picked patch: column of F"});
    return names;
}

/// A column that a patch is in, and the share of it that is the patch's.
struct Holder {
    std::uint32_t column;
    double share;
};

/// The patch itself and the clusters that hold it, ascending.
std::vector<Holder> holders_of(const FormFactorMatrix& factors, std::uint32_t patch) {
    std::vector<Holder> holders{{patch, 1.0}};
    if (factors.clusters() == nullptr) {
        return holders;
    }
    const SourceClusters& clusters = *factors.clusters();
    const auto holds = [&](std::uint32_t node) {
        const auto patches = clusters.patches(node);
        return std::find(patches.begin(), patches.end(), patch) != patches.end();
    };
    for (std::uint32_t node = 0;;) { // from the root down, which ascends
        holders.push_back({factors.size() + node, clusters.share(patch, node)});
        const std::uint32_t child = clusters.nodes()[node].child;
        if (child == 0) {
            return holders;
        }
        node = holds(child) ? child : child + 1;
    }
}

constexpr double none = std::numeric_limits<double>::quiet_NaN();
/// Logarithmic scales of factors span so much.
constexpr double factor_range = 1e-4;

/// Why a solution does not have a quantity; null if it does.
/// @param factors  whether there are form factors, too
const char* why_not_of(Quantity quantity, const Solution& solution, bool factors) {
    switch (quantity) {
    case Quantity::error:
    case Quantity::error_factors:
        return solution.error ? nullptr : "no errors were estimated of this light";
    case Quantity::error_patch_size:
        return solution.patch_size_error ? nullptr : "estimated by `hemi solve`: open its result";
    case Quantity::environment:
    case Quantity::blocked:
    case Quantity::row_error:
        return solution.row_sum.empty() ? "needs form factors" : nullptr;
    case Quantity::irradiance:
        return !factors && solution.irradiance.empty() ? "needs form factors" : nullptr;
    case Quantity::direct:
        return solution.direct.empty() ? "there is neither sun nor sky" : nullptr;
    case Quantity::temperature:
    case Quantity::net_flux:
        return solution.temperature.empty() ? "needs a scene with temperatures" : nullptr;
    case Quantity::radiosity:
    case Quantity::exitance:
    case Quantity::reflectance:
    case Quantity::emissivity:
    case Quantity::area:
        break;
    }
    return nullptr;
}

/// Any look can be shown: a logarithmic scale begins above 0, or is none.
ColourScale shown_scale(FalseColours& shown) {
    if (shown.logarithmic) {
        constexpr double decades = 1e-3;
        const auto highest = [&shown] {
            double high = 0.0;
            for (const double value : shown.values) {
                high = value > high ? value : high;
            }
            return shown.range ? (*shown.range)[1] : high;
        }();
        shown.logarithmic = highest > 0.0;
        if (shown.logarithmic && shown.range && !((*shown.range)[0] > 0.0)) {
            (*shown.range)[0] = decades * highest;
        }
    }
    return scale_of(shown);
}

} // namespace

std::span<const ShownName> shown_names() {
    static const std::vector<ShownName> names = all_names();
    return names;
}

std::optional<Shown> shown_by_word(std::string_view word) {
    const auto names = shown_names();
    const auto found =
        std::find_if(names.begin(), names.end(), [word](const ShownName& name) { return name.word == word; });
    return found == names.end() ? std::nullopt : std::optional(found->shown);
}

const ShownName& name_of(const Shown& shown) {
    const auto names = shown_names();
    return *std::find_if(names.begin(), names.end(),
                         [&shown](const ShownName& name) { return name.shown == shown; });
}

const char* why_not(const Shown& shown, const ViewerInput& input, std::optional<std::uint32_t> picked) {
    if (shown.view == View::row || shown.view == View::column || shown.view == View::findings) {
        if (input.factors == nullptr) {
            return input.factor_settings ? "not computed"
                                         : "a stored solution has no form factors; open the scene instead";
        }
        return picked || shown.view == View::findings ? nullptr : "click a patch first";
    }
    if (shown.view != View::quantity) {
        return nullptr;
    }
    if (is_of_heat(shown.quantity) && input.solution.temperature.empty()) {
        return input.heat != nullptr ? "not solved for yet" : "needs a scene with temperatures";
    }
    return why_not_of(shown.quantity, input.solution, input.factors != nullptr);
}

const char* why_no_difference(const Shown& shown, const ViewerInput& input) {
    if (!input.compared) {
        return "drop a second result on the first";
    }
    if (shown.view != View::quantity) {
        return "differences are of quantities, such as radiosity";
    }
    return why_not_of(shown.quantity, input.compared->solution, false) == nullptr
               ? nullptr
               : "the result that it is compared with does not have this";
}

bool shows_difference(const Look& look) {
    return look.difference && look.shown.view == View::quantity;
}

ColourMap& map_of(Look& look) {
    return shows_difference(look) ? look.difference_map : look.map;
}

std::vector<std::string> channel_choices(const std::vector<std::string>& channels) {
    std::vector<std::string> choices{"mean", "sum"};
    const auto has = [&channels](const char* name) {
        return std::find(channels.begin(), channels.end(), name) != channels.end();
    };
    if (has("red") && has("green") && has("blue")) {
        choices.emplace_back("luminance");
    }
    for (const std::string& channel : channels) {
        if (std::find(choices.begin(), choices.end(), channel) == choices.end()) {
            choices.push_back(channel);
        }
    }
    return choices;
}

Field quantity_field(const Look& look, const PatchMesh& mesh, const Lit& lit, const Light& light,
                     const Compared* compared) {
    const Quantity quantity = look.shown.quantity;
    const bool difference = shows_difference(look) && compared != nullptr;
    Field field{difference ? difference_colours(
                                 compare_solutions({lit.scene, mesh, lit.solution},
                                                   {*compared->scene, *compared->mesh, compared->solution},
                                                   compared->pairs, quantity, look.channel))
                           : patch_quantity(quantity, lit.scene, mesh, lit.solution, look.channel),
                {}};
    if (quantity == Quantity::radiosity || quantity == Quantity::irradiance) {
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            field.shown.values[i] = light.knows(i) ? field.shown.values[i] : none;
        }
    }
    if (look.celsius && !difference) {
        show_in_celsius(field.shown);
    }
    field.shown.map = difference ? look.difference_map : look.map;
    field.shown.bands = look.bands;
    field.shown.iso_lines = look.iso_lines;
    field.shown.logarithmic = look.logarithmic && !difference;
    if (look.range) {
        field.shown.range = look.range;
    }
    field.scale = shown_scale(field.shown);
    return field;
}

Field factor_field(const Look& look, const FormFactorMatrix& factors, std::uint32_t picked,
                   double usual_factor) {
    const bool row = look.shown.view == View::row;
    Field field{
        {row ? factors_from(factors, picked) : factors_to(factors, picked),
         row ? "F(i, j), i picked: leaves i, arrives at j" : "F(j, i), i picked: leaves j, arrives at i", ""},
        {},
        "0"};
    std::replace(field.shown.values.begin(), field.shown.values.end(), 0.0, none);
    const double top = usual_factor > 0.0 ? round_up(usual_factor) : 1.0;
    field.shown.range = {look.logarithmic_factors ? top * factor_range : 0.0, top};
    field.shown.logarithmic = look.logarithmic_factors;
    field.shown.map = look.map;
    field.shown.bands = look.bands;
    field.shown.iso_lines = look.iso_lines;
    field.scale = shown_scale(field.shown);
    return field;
}

double usual_largest_factor(const FormFactorMatrix& factors) {
    std::vector<double> of_rows;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        const auto patches =
            std::lower_bound(row.columns.begin(), row.columns.end(), factors.size()) - row.columns.begin();
        const auto found = std::max_element(row.values.begin(), row.values.begin() + patches);
        if (patches > 0) {
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
    visit_sources(factors, factors.row(patch),
                  [&result](std::uint32_t j, double factor) { result[j] += factor; });
    return result;
}

std::vector<double> factors_to(const FormFactorMatrix& factors, std::uint32_t patch) {
    std::vector<double> result(factors.size(), 0.0);
    const std::vector<Holder> holders = holders_of(factors, patch);
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        const RowView row = factors.row(j);
        auto next = row.columns.begin();
        for (const Holder& holder : holders) {
            next = std::lower_bound(next, row.columns.end(), holder.column);
            if (next != row.columns.end() && *next == holder.column) {
                result[j] +=
                    holder.share *
                    static_cast<double>(row.values[static_cast<std::size_t>(next - row.columns.begin())]);
            }
        }
    }
    return result;
}

std::vector<std::array<float, 3>> item_colours(const PatchMesh& mesh) {
    std::vector<std::array<float, 3>> colours;
    colours.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        colours.push_back(item_colour(i));
    }
    return colours;
}

std::vector<std::array<float, 3>> group_colours(const PatchMesh& mesh) {
    std::vector<std::array<float, 3>> colours;
    colours.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        colours.push_back(item_colour(mesh.group(i)));
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
    if (look.shown.view != View::picture) {
        settings.shading = Shading::flat;
        settings.tone_mapping = ToneMapping::linear;
        settings.exposure = 1.0;
        settings.outlines = look.outlines || look.shown.view == View::outlines;
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
