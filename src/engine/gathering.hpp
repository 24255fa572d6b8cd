#pragma once

#include "hemi/engine/engine.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// What arrives at a patch from light that is known elsewhere, by the patch's own row and before there are
/// all of them: sum_j F(i, j) B_j + e_i B_env, W/m².
///
/// Rows of form factors say it exactly. Of rows of visibility F(i, j) is made as the hybrid makes it, by what
/// i alone sees: exact exchange areas where patches are near each other, from centre to centre (within a few
/// percent, sums of them within one) where they are far. So it is provisional: rows that are combined and
/// repaired differ a little.
/// Thread-safe. Memory: N·channels, and for visibility about 350 bytes a patch.
class Gathering {
public:
    /// @param mesh         is read here and not kept
    /// @param quantity     what the values of rows are
    /// @param radiosity    B of all patches, N·channels
    /// @param environment  B_env, channels; empty: zero
    /// @throws InvalidArgument for sizes that do not match
    Gathering(const PatchMesh& mesh, RowQuantity quantity, std::uint32_t channels,
              std::vector<double> radiosity, std::span<const double> environment);

    /// Irradiance of `patch`, one value a channel.
    void gather(std::uint32_t patch, const RowView& row, std::span<double> irradiance) const;

private:
    /// Small, since every row goes through all of them.
    struct Place {
        glm::vec3 centre; ///< from the middle of the scene
        float radius;     ///< of the sphere about it that holds the patch
        glm::vec3 normal;
        float area;
    };
    [[nodiscard]] float unoccluded_factor(std::uint32_t i, std::uint32_t j) const;

    std::uint32_t channels_;
    std::vector<double> radiosity_;
    std::vector<double> environment_;
    std::vector<std::uint8_t> bright_; ///< whether a patch sends anything
    // Of visibility only:
    std::vector<Place> places_;
    std::optional<ExchangeAreas> areas_;
};

} // namespace hemi
