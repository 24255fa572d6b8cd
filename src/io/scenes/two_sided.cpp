#include "io/scenes/two_sided.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::io {

void make_two_sided(Scene& scene, const std::vector<std::string>& groups, const std::string& file) {
    for (const std::string& name : groups) {
        const auto found = std::find(scene.groups.begin(), scene.groups.end(), name);
        if (found == scene.groups.end()) {
            throw InputError(fmt::format("{}: no group {} to make two-sided{}", file, in_quotes(name),
                                         did_you_mean_or_list(name, scene.groups)));
        }
        const auto group = static_cast<std::uint32_t>(found - scene.groups.begin());
        for (Surface& surface : scene.surfaces) {
            surface.two_sided = surface.two_sided || surface.group == group;
        }
    }
}

} // namespace hemi::io
