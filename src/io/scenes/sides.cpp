#include "io/scenes/sides.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/text.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::io {

namespace {

/// Which groups are named; "*" names all.
std::vector<bool> named_groups(const Scene& scene, const std::vector<std::string>& names, const char* purpose,
                               const std::string& file) {
    std::vector<bool> named(scene.groups.size(), false);
    for (const std::string& name : names) {
        const auto found = std::find(scene.groups.begin(), scene.groups.end(), name);
        if (found != scene.groups.end()) {
            named[static_cast<std::size_t>(found - scene.groups.begin())] = true;
        } else if (name == "*") {
            named.assign(scene.groups.size(), true);
        } else {
            throw InvalidArgument(fmt::format("{}: no group {} to {}{}", file, in_quotes(name), purpose,
                                              did_you_mean_or_list(name, scene.groups)));
        }
    }
    return named;
}

} // namespace

void set_sides(Scene& scene, const SceneReaderOptions& options, const std::string& file,
               Diagnostics& diagnostics, std::vector<bool> exported) {
    const auto one_sided = named_groups(scene, options.one_sided_groups, "make one-sided", file);
    const auto two_sided = named_groups(scene, options.two_sided_groups, "make two-sided", file);
    const auto flipped = named_groups(scene, options.flipped_groups, "turn round", file);
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
        if (one_sided[g] && two_sided[g]) {
            throw InvalidArgument(fmt::format("{}: group {} cannot be made both two-sided and one-sided",
                                              file, in_quotes(scene.groups[g])));
        }
    }
    for (Surface& surface : scene.surfaces) {
        surface.two_sided = two_sided[surface.group] || (surface.two_sided && !one_sided[surface.group]);
    }
    if (!exported.empty()) {
        for (std::size_t g = 0; g < exported.size(); ++g) {
            exported[g] = exported[g] && !two_sided[g];
        }
        const OneSidedBodies closed = make_bodies_one_sided(scene, exported);
        if (closed.faces > 0) {
            diagnostics.warn(fmt::format(
                "{}: {} taken as one-sided: they close in {}, of which one side meets nothing (the inside is "
                "left of {}, the outside of {}); --two-sided GROUP keeps both",
                file, plural(closed.faces, "double-sided face", "double-sided faces"),
                plural(closed.inwards + closed.outwards, "body", "bodies"), closed.inwards, closed.outwards));
        }
    }
    const OrientedFaces oriented = orient(scene, options.orientation);
    if (options.orientation != Orientation::as_read) {
        diagnostics.note(
            fmt::format("{}: {} of {} faces turned round", file, oriented.turned, scene.surfaces.size()));
    }
    if (oriented.undecided > 0) {
        diagnostics.warn(fmt::format("{}: {} no volume and {} not turned", file,
                                     plural(oriented.undecided, "face encloses", "faces enclose"),
                                     oriented.undecided == 1 ? "is" : "are"));
    }
    for (Surface& surface : scene.surfaces) {
        if (flipped[surface.group]) {
            turn_round(surface);
        }
    }
}

} // namespace hemi::io
