#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/core/patch_cuts.hpp"
#include "hemi/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// How surfaces are cut into patches, over the scene's own wishes.
struct Subdivision {
    std::optional<double> patch_size;              ///< Longest patch edge, scene units.
    std::optional<std::uint32_t> patches_per_face; ///< About so many: k x k with the smallest k² >= N.
    std::vector<std::vector<GridPart>> parts{};    ///< As PatchCuts::parts.

    bool operator==(const Subdivision&) const = default; ///< member by member
};

/// Corners of one patch, counter-clockwise about its normal.
struct PatchCorners {
    std::array<Vec3, 4> points{}; ///< the fourth is unused for a triangle
    std::uint32_t count = 4;      ///< 3 or 4

    /// The corners that are used.
    [[nodiscard]] std::span<const Vec3> polygon() const { return {points.data(), count}; }
};

/// How a patch is cut.
enum class Cut {
    in_four,  ///< both ways
    by_shape, ///< in two across the longer way where a quadrilateral is twice as long as wide or more
};

/// A patch that is to be cut in half along u, along v of its surface, or both; one of a triangle in four in
/// any case.
struct PatchSplit {
    std::uint32_t patch = 0; ///< its index
    bool along_u = true;     ///< whether its parts have half its width along u
    bool along_v = true;     ///< the same along v
};

struct SplitMesh;
struct WholeFaces;

/// The scene cut into patches, the unit of all that follows: row i and column i of F are patch i.
///
/// Order: surfaces as listed; patches of a surface row by row (u fastest); a triangle cut n² ways goes strip
/// by strip from the edge vertex 0 -> vertex 1, the strip's upright and inverted triangles in turn; where
/// patches differ in size, the parts of a cell come in its place; a two-sided surface's back patches follow
/// its front patches.
/// Memory: about 70 bytes a patch.
class PatchMesh {
public:
    /// Cuts the scene, which is not needed afterwards.
    /// @throws InvalidArgument if there would be 2^31 patches or more, or if parts do not fill their
    /// surfaces;
    ///   InputError as validate(scene).
    explicit PatchMesh(const Scene& scene, const Subdivision& subdivision = {});

    /// N, the number of patches.
    [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(areas_.size()); }

    /// Areas of all patches, scene units squared.
    [[nodiscard]] std::span<const double> areas() const noexcept { return areas_; }
    /// Area centroid of each patch, also its eye point.
    [[nodiscard]] std::span<const Vec3> centres() const noexcept { return centres_; }
    /// Index of the surface that patch `i` belongs to, into surfaces().
    [[nodiscard]] std::span<const std::uint32_t> surface_of() const noexcept { return surface_of_; }

    /// Unit normal, towards the side that the patch radiates to.
    [[nodiscard]] Vec3 normal(std::uint32_t patch) const;
    /// Index into groups().
    [[nodiscard]] std::uint32_t group(std::uint32_t patch) const {
        return surfaces_[surface_of_[patch]].group;
    }
    /// Index into Scene::materials.
    [[nodiscard]] std::uint32_t material(std::uint32_t patch) const {
        return surfaces_[surface_of_[patch]].material;
    }
    /// Whether the patch is on the back of a two-sided surface.
    [[nodiscard]] bool is_back(std::uint32_t patch) const;
    /// Corners, counter-clockwise about the patch's normal.
    [[nodiscard]] PatchCorners corners(std::uint32_t patch) const;
    /// Grid coordinates of the patch's centroid on its surface: u in (0, grid.u), v in (0, grid.v) measured
    /// along the surface's parameters (bilinear for quadrilaterals, barycentric times n for triangles).
    [[nodiscard]] std::array<double, 2> grid_coordinates(std::uint32_t patch) const;

    /// The scene's surfaces.
    [[nodiscard]] std::span<const Surface> surfaces() const noexcept { return surfaces_; }
    /// Subdivision of surface `s`; of the cells only, where they have parts.
    [[nodiscard]] Grid grid(std::uint32_t s) const { return grids_[s]; }
    /// The patches of surface `s` where they differ in size, in their order; else empty.
    [[nodiscard]] std::span<const GridPart> parts(std::uint32_t s) const {
        return parts_.empty() ? std::span<const GridPart>() : parts_[s];
    }
    /// Those of all surfaces, as Subdivision has them.
    [[nodiscard]] const std::vector<std::vector<GridPart>>& parts() const noexcept { return parts_; }
    /// How all surfaces are cut.
    [[nodiscard]] PatchCuts cuts() const { return {grids_, parts_}; }
    /// The same surfaces cut otherwise.
    /// @throws InvalidArgument if the cuts are of another number of surfaces, a grid has no cell, parts do
    /// not fill their surfaces, or for 2^31 patches or more
    [[nodiscard]] PatchMesh cut(const PatchCuts& cuts) const;
    /// Corners of a part of surface `s`, counter-clockwise about the front.
    [[nodiscard]] PatchCorners part_corners(std::uint32_t s, const GridPart& part) const;
    /// First patch of surface `s`; `s` may equal the number of surfaces (then: size()).
    [[nodiscard]] std::uint32_t first_patch(std::uint32_t s) const { return first_patch_[s]; }
    /// Patches on one side of surface `s`: u·v, or n² for a triangle; or the number of its parts.
    [[nodiscard]] std::uint32_t patches_per_side(std::uint32_t s) const;
    /// Unit normal of the front of surface `s`.
    [[nodiscard]] const Vec3& surface_normal(std::uint32_t s) const { return surface_normals_[s]; }

    /// Names of the scene's groups.
    [[nodiscard]] const std::vector<std::string>& groups() const noexcept { return groups_; }
    /// Of all corners.
    [[nodiscard]] const Bounds& bounds() const noexcept { return bounds_; }
    /// Length below which differences of coordinates are rounding: it grows with the distance of the scene
    /// from the origin.
    [[nodiscard]] double rounding() const;

    /// What the scene repeats itself by: patches are those of the part that is given, see ImageMesh.
    [[nodiscard]] const std::optional<Symmetry>& symmetry() const noexcept { return symmetry_; }

    /// The same surfaces with some patches cut. What is cut on one side of a two-sided surface is on the
    /// other.
    /// @param splits  in any order
    /// @throws InvalidArgument if an edge would be cut more than 65,535 ways, or for 2^31 patches or more
    [[nodiscard]] SplitMesh split(std::span<const PatchSplit> splits) const;
    /// The same with all of them cut in one way.
    /// @param patches  indices, in any order
    /// @param how      in four, or as their shape asks for
    /// @throws InvalidArgument as above
    [[nodiscard]] SplitMesh split(std::span<const std::uint32_t> patches, Cut how = Cut::by_shape) const;
    /// How Cut::by_shape cuts a patch.
    [[nodiscard]] PatchSplit split_by_shape(std::uint32_t patch) const;

    /// The mesh with one patch a side for every face whose pieces (Surface::continues) are one patch each.
    [[nodiscard]] WholeFaces whole_faces() const;

    /// Hash over the corners, subdivision and sidedness of every surface, in order, and the symmetry: equal
    /// for equal geometry, whatever the materials, lamps and names. 64-bit FNV-1a.
    [[nodiscard]] std::uint64_t geometry_hash() const;

private:
    friend class ImageMesh;
    PatchMesh() = default;
    [[nodiscard]] PatchMesh with_images(const SceneImages& images) const;
    [[nodiscard]] std::uint32_t mirrored(std::uint32_t s, std::uint32_t local) const;
    void check_parts() const;
    void measure();
    void measure_face(std::uint32_t face, const PatchMesh& pieces, std::uint32_t first, std::uint32_t end);
    [[nodiscard]] PatchCorners local_corners(std::uint32_t s, std::uint32_t local) const;

    std::vector<Surface> surfaces_;
    std::vector<Grid> grids_;
    std::vector<std::vector<GridPart>> parts_;
    std::vector<std::uint32_t> first_patch_;
    std::vector<Vec3> surface_normals_;
    std::vector<std::string> groups_;
    std::optional<Symmetry> symmetry_;
    std::vector<double> areas_;
    std::vector<Vec3> centres_;
    std::vector<std::uint32_t> surface_of_;
    Bounds bounds_;
};

/// A mesh and the coarser one that it was made of.
struct SplitMesh {
    PatchMesh mesh; ///< the finer one
    std::vector<std::uint32_t>
        parents; ///< of each of its patches the one of the coarser mesh that it lies in
};

/// Patches that results are about where faces were read in pieces.
struct WholeFaces {
    /// Areas and centres of such a face are those of all its pieces, its normal is their mean by area. In
    /// surfaces() and corners() is its first piece alone: nothing can be computed with this mesh.
    PatchMesh mesh;
    std::vector<std::uint32_t> patch_of; ///< of every patch of the mesh in pieces, the one that it is part of
};

/// How a patch size cuts a surface.
/// @param surface     of the scene
/// @param patch_size  longest edge of a patch, scene units, above 0
/// @throws InvalidArgument if an edge would be cut into more than 1e6 pieces
[[nodiscard]] Grid grid_for_size(const Surface& surface, double patch_size);
/// The size of patches as a patch size has it: the longest edge, the mean over their area; scene units.
[[nodiscard]] double mean_patch_size(const PatchMesh& mesh);

/// Makes PatchMesh(scene, subdivision) a mesh again that was split or cut otherwise than the scene wants.
/// @param scene        that the mesh is of; gets its surfaces and their grids
/// @param subdivision  becomes that of the mesh
/// @param mesh         with the scene's materials and groups
void adopt_mesh(Scene& scene, Subdivision& subdivision, const PatchMesh& mesh);

/// A property of materials, spread over the patches: N·channels, channel c of patch i at [i·channels + c].
/// @param mesh       N patches
/// @param materials  those of the scene, by the surfaces' index; all with the same number of channels
/// @param property   &Material::reflectance or &Material::exitance
[[nodiscard]] std::vector<double> patch_values(const PatchMesh& mesh, std::span<const Material> materials,
                                               std::vector<double> Material::*property);

/// Emissivity of every patch: 1 - reflectance, the mean over the channels; N values.
/// @param mesh       N patches
/// @param materials  those of the scene, by the surfaces' index; all with the same number of channels, at
/// least 1
[[nodiscard]] std::vector<double> emissivities(const PatchMesh& mesh, std::span<const Material> materials);

} // namespace hemi
