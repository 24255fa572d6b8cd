#include "cli/report/group_sizes.hpp"

namespace hemi::cli {

std::vector<GroupSize> group_sizes(std::span<const double> areas, std::span<const std::uint32_t> group_of,
                                   std::size_t groups) {
    std::vector<GroupSize> sizes(groups);
    for (std::size_t i = 0; i < group_of.size(); ++i) {
        GroupSize& group = sizes[group_of[i]];
        ++group.patches;
        group.area += areas[i];
    }
    return sizes;
}

std::vector<GroupSize> group_sizes(const PatchMesh& mesh, std::span<const double> areas) {
    std::vector<std::uint32_t> group_of(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        group_of[i] = mesh.group(i);
    }
    return group_sizes(areas, group_of, mesh.groups().size());
}

} // namespace hemi::cli
