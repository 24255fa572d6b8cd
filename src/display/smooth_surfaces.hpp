#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Patches with their coincident corners made one, and which patches meet where.
class SmoothSurfaces {
public:
    /// Largest angle between the normals of two patches of one smooth surface, degrees.
    static constexpr double crease_angle = 20.0;
    /// Corners nearer to each other than this share of the scene's diagonal are one vertex.
    static constexpr double weld_tolerance = 1e-7;

    /// @param across_materials  whether surfaces go on where another material or group begins
    explicit SmoothSurfaces(const PatchMesh& mesh, bool across_materials = false);

    [[nodiscard]] std::uint32_t vertex_count() const noexcept {
        return static_cast<std::uint32_t>(vertices_.size());
    }
    /// The one position of all corners welded into vertex `v`.
    [[nodiscard]] const Vec3& position(std::uint32_t v) const { return vertices_[v]; }
    /// Vertices of a patch's corners, 3 or 4.
    [[nodiscard]] std::span<const std::uint32_t> corners(std::uint32_t patch) const {
        return {corners_.data() + std::size_t{patch} * 4, counts_[patch]};
    }
    /// Patches that have vertex `v` as a corner or in the middle of an edge, ascending.
    [[nodiscard]] std::span<const std::uint32_t> patches_at(std::uint32_t v) const {
        return {incident_.data() + first_incident_[v], first_incident_[v + 1] - first_incident_[v]};
    }
    /// A vertex in the middle of an edge of a larger patch, in whose plane the smaller ones lie.
    struct Hanging {
        std::uint32_t vertex;
        std::uint32_t patch; ///< the larger one
        std::uint32_t from;  ///< ends of its edge
        std::uint32_t to;
        double share; ///< of the way from one to the other
    };
    /// All of them, those of long edges first: ends that hang themselves come before what hangs between them.
    [[nodiscard]] std::span<const Hanging> hanging() const { return hanging_; }

    /// Whether light runs smoothly from one patch to the other where they meet: same material and group, or
    /// across these; normals within the crease angle.
    [[nodiscard]] bool continues(std::uint32_t a, std::uint32_t b) const;
    /// The same of two patches at vertex `v`, where something may stand between them: a sheet on a floor has
    /// light on one of its sides and shadow on the other.
    [[nodiscard]] bool continues_at(std::uint32_t v, std::uint32_t a, std::uint32_t b) const;

private:
    void weld(const PatchMesh& mesh);
    void connect();

    void divide(const PatchMesh& mesh);
    void find_sectors(const PatchMesh& mesh, std::uint32_t v);
    void keep_true_hanging(const PatchMesh& mesh);
    [[nodiscard]] std::array<Vec3, 2> rims(std::uint32_t v, std::uint32_t patch) const;
    void add_hanging(std::uint32_t vertex, std::uint32_t patch, std::uint32_t from, std::uint32_t to);

    struct Appearance {
        Vec3 normal;
        std::uint32_t material;
        std::uint32_t group;
    };
    std::vector<Vec3> vertices_;
    std::vector<std::uint32_t> corners_; ///< 4 a patch
    std::vector<std::uint8_t> counts_;
    std::vector<Appearance> looks_;
    std::vector<std::size_t> first_incident_;
    std::vector<std::uint32_t> incident_;
    /// Of every entry of incident_, which side of what stands there its patch is on; empty: nothing stands.
    std::vector<std::uint8_t> sectors_;
    std::vector<Hanging> hanging_;
    double tolerance_ = 0.0;
    bool across_materials_;
};

} // namespace hemi
