#include "viewer/scene_view.hpp"

#include "display/false_colour_scale.hpp"
#include "display/legend.hpp"
#include "display/painted.hpp"
#include "viewer/dots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi::viewer {

void SceneView::show(const Document& document, const Look& look, std::optional<std::uint32_t> picked) {
    const ViewerInput& input = document.input();
    const double exposure = document.exposure() * std::exp2(look.stops);
    field_.reset();
    if (look.shown.view == View::quantity) {
        field_ = quantity_field(look, *input.mesh, document.lit(look.shown.quantity == Quantity::irradiance),
                                document.light(), input.compared.get());
    } else if (look.shown.view == View::row || look.shown.view == View::column) {
        field_ = factor_field(look, input.factors->matrix, *picked, document.usual_factor());
    }
    colours_.clear();
    key_.reset();
    if (field_) {
        colours_ = value_colours(field_->shown.values, field_->scale, *input.mesh);
    } else if (look.shown.view == View::items) {
        colours_ = item_colours(*input.mesh);
    } else if (look.shown.view == View::groups) {
        colours_ = group_colours(*input.mesh);
    } else if (look.shown.view == View::findings) {
        colours_ = finding_colours(document.findings(), *input.mesh);
        key_ = finding_key(document.findings());
    } else if (look.shown.view == View::outlines) {
        colours_ = plain_colours(*input.mesh);
    }
    settings_ = picture_settings(look, input.picture, exposure, {1, 1});
    light_ = document.light_mesh();
    evenly_lit_ = look.shown.view == View::picture && document.evenly_lit();
    if (look.shown.view == View::picture && !evenly_lit_) {
        light_ = with_unknown_grey(std::move(light_), *input.mesh, document.light(), exposure);
    }
    PictureMesh drawn = colours_.empty() ? light_ : painted(light_, colours_);
    if (field_ && field_->scale.lines) {
        put_iso_values(drawn, *input.mesh,
                       field_->shown.across_materials ? document.surfaces_across() : document.surfaces(),
                       field_->shown.values, field_->scale);
        settings_.iso_lines = iso_positions(field_->scale);
    }
    drawn = with_images(std::move(drawn), *input.mesh);
    drawn_patches_ = drawn.patches.size() / 3;
    dots_ = dots_of(input, look);
    renderer_.upload(dots_ ? with_dots(std::move(drawn), *dots_, settings_) : drawn);
}

std::vector<std::array<float, 3>> SceneView::colours() const {
    return colours_.empty() ? light_colours(light_, settings_.exposure, settings_.tone_mapping) : colours_;
}

std::optional<std::array<float, 3>> SceneView::environment_colour() const {
    if (!colours_.empty() || settings_.background || light_.environment == std::array<float, 3>{}) {
        return std::nullopt;
    }
    PictureMesh sky;
    sky.patches.assign(light_.environment.begin(), light_.environment.end());
    return light_colours(sky, settings_.exposure, settings_.tone_mapping).front();
}

PictureSettings SceneView::settings(std::array<std::uint32_t, 2> size, std::uint32_t samples) const {
    PictureSettings settings = settings_;
    settings.width = std::max(size[0], 1U);
    settings.height = std::max(size[1], 1U);
    settings.samples = samples;
    settings.cut = cut_;
    return settings;
}

void SceneView::draw(const Camera& camera, SceneTarget& target, std::uint32_t samples) {
    renderer_.draw(camera, settings(target.size(), samples), target.framebuffer());
}

Picture SceneView::picture(const Camera& camera, std::array<std::uint32_t, 2> size, std::uint32_t samples) {
    Picture picture = renderer_.picture(camera, settings(size, samples));
    if (evenly_lit_) { // which is no radiosity
        std::fill(picture.linear.begin(), picture.linear.end(), 0.0F);
    }
    if (field_) {
        draw_legend(picture, legend_scale(field_->shown, field_->scale),
                    legend_title(field_->shown, field_->scale, field_->grey),
                    values_beyond(field_->shown, field_->scale));
    }
    if (key_) {
        draw_key(picture, "What check finds", *key_);
    }
    if (dots_) {
        draw_dots_legend(picture, *dots_, field_ ? 1 : 0);
    }
    return picture;
}

std::optional<std::uint32_t> SceneView::item(const Camera& camera, std::array<std::uint32_t, 2> size,
                                             std::uint32_t x, std::uint32_t y) {
    const std::optional<std::uint32_t> item = renderer_.item(camera, settings(size, 1), x, y);
    if (!item || *item >= drawn_patches_) { // of a dot
        return std::nullopt;
    }
    return *item % static_cast<std::uint32_t>(light_.patches.size() / 3); // images follow one another
}

bool SceneView::hides_backs(const Camera& camera, std::array<std::uint32_t, 2> size) {
    constexpr std::uint32_t coarser = 16;
    PictureSettings settings = this->settings({size[0] / coarser, size[1] / coarser}, 1);
    const auto patches = [&](bool backs) {
        settings.backs = backs;
        std::vector<std::uint32_t> items = renderer_.items(camera, settings);
        for (std::uint32_t& item : items) { // those of dots stand behind all patches'
            item = item > light_.patches.size() / 3 ? 0 : item;
        }
        return items;
    };
    return patches(false) != patches(true);
}

} // namespace hemi::viewer
