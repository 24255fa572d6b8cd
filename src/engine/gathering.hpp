#pragma once

#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// What arrives at a patch from light that is known elsewhere, by the patch's own row and before there are
/// all of them: sum_j F(i, j) B_j + e_i B_env, W/m².
///
/// Rows of form factors give it exactly. For rows of visibility F(i, j) = F0(i, j) V(i, j) with V as i alone
/// sees it and F0 the unoccluded factor: exact where patches are near each other, from centre to centre
/// (within a few per cent, sums of them within one) where they are far. That is provisional: rows that are
/// combined and repaired differ a little. Rows of visibility are over all images of a scene with symmetry.
/// Thread-safe. Memory: N·channels, and about 350 bytes a patch for unoccluded factors.
class Gathering {
public:
    /// @param mesh         is read here and not kept
    /// @param radiosity    B of all patches, N·channels
    /// @param environment  B_env, channels; empty: zero
    /// @throws InvalidArgument for sizes that do not match
    Gathering(const PatchMesh& mesh, std::uint32_t channels, std::vector<double> radiosity,
              std::span<const double> environment);

    /// Irradiance of `patch`, one value a channel.
    void gather(std::uint32_t patch, const RowView& row, std::span<double> irradiance) const;
    void gather(std::uint32_t patch, const VisibilityRow& row, std::span<double> irradiance) const;

private:
    Gathering(const ImageMesh& images, std::uint32_t channels, std::vector<double> radiosity,
              std::span<const double> environment);
    /// Small, since every row goes through all of them.
    struct Place {
        glm::vec3 centre; ///< from the middle of the scene
        float radius;     ///< of the sphere about it that holds the patch
        glm::vec3 normal;
        float area;
    };
    template <class Factor>
    void gather(double environment, std::span<const std::uint32_t> columns, const Factor& factor,
                std::span<double> irradiance) const;
    [[nodiscard]] float unoccluded_factor(std::uint32_t i, std::uint32_t j) const;

    std::uint32_t channels_;
    std::vector<double> radiosity_;
    std::vector<double> environment_;
    std::vector<std::uint8_t> bright_; ///< whether a patch sends anything
    // For rows of visibility:
    std::vector<Place> places_;
    ExchangeAreas areas_;
};

} // namespace hemi
