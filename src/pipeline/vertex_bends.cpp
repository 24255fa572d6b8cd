#include "pipeline/vertex_bends.hpp"

#include <cstddef>
#include <cstdint>

namespace hemi {

std::vector<double> vertex_bends(const PatchMesh& mesh, const Solution& solution,
                                 std::span<const double> visible) {
    const std::uint32_t channels = solution.channels;
    std::vector<double> bends(visible.size(), 0.0);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t count = mesh.corners(i).count;
        for (std::uint32_t c = 0; c < channels; ++c) {
            double sum = 0.0;
            for (std::uint32_t k = 0; k < count; ++k) {
                sum +=
                    static_cast<double>(solution.vertex_radiosity[(std::size_t{i} * 4 + k) * channels + c]);
            }
            const std::size_t at = std::size_t{i} * channels + c;
            bends[at] = sum / count - visible[at];
        }
    }
    return bends;
}

} // namespace hemi
