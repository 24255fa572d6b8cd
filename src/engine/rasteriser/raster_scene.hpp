#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/grid_map.hpp"
#include "engine/hemicube/raster_coordinates.hpp"
#include "hemi/core/geometry.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <span>
#include <vector>

namespace hemi {

/// Allocator of vectors that SIMD code loads whole cache lines of.
template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t alignment{64};

    CacheLineAllocator() = default;
    template <class U>
    CacheLineAllocator(const CacheLineAllocator<U>& /*other*/) noexcept {}

    [[nodiscard]] T* allocate(std::size_t count) {
        return static_cast<T*>(::operator new(count * sizeof(T), alignment));
    }
    void deallocate(T* memory, std::size_t /*count*/) noexcept { ::operator delete(memory, alignment); }
    bool operator==(const CacheLineAllocator&) const = default;
};
template <class T>
using CacheLineVector = std::vector<T, CacheLineAllocator<T>>;

/// Triangles that lie near one another: culled and transformed together.
struct TriangleCluster {
    std::uint32_t triangles = 0; ///< in slots [64 c, 64 c + triangles) of cluster c
    std::uint32_t vertices = 0;  ///< in slots [64 c, 64 c + vertices)
    bool whole = true;           ///< whether no polygon has triangles in other clusters, too
};

/// The draw list as the CPU rasteriser takes it, shared by all threads: polygons that show one draw id as
/// clusters of triangles, and the polygons whose draw id depends on the texel.
struct RasterScene {
    explicit RasterScene(const DrawList& the_list);

    static constexpr std::uint32_t cluster_size = 64; ///< most triangles, and most vertices, of a cluster
    static constexpr std::uint32_t group_size = 16;   ///< most grid polygons of a group
    static constexpr std::uint32_t corner_slots = 8;

    const DrawList& list;
    RasterCoordinates coordinates;

    std::vector<TriangleCluster> clusters;
    std::array<CacheLineVector<float>, 3> vertex_high; ///< x, y, z; 64 slots a cluster
    std::array<CacheLineVector<float>, 3> vertex_low;
    CacheLineVector<std::uint8_t> corners; ///< 3·64 a cluster: vertices of its triangles, first corners first
    /// Planes of the triangles, height(p) = normal · p - plane[3]; 64 slots a cluster.
    std::array<CacheLineVector<float>, 4> plane;
    CacheLineVector<std::uint32_t> front_id; ///< draw ids; 64 slots a cluster
    CacheLineVector<std::uint32_t> back_id;
    CacheLineVector<std::uint32_t> polygon; ///< into the draw list; 64 slots a cluster

    /// A polygon of several cells: what tells whether it can be seen.
    struct GridPolygon {
        std::uint32_t polygon;         ///< into the draw list
        std::array<float, 3> centre{}; ///< with `radius`: a sphere round it, in raster coordinates
        float radius = 0.0f;
        std::array<float, 4> plane{};   ///< height(p) = normal · p - plane[3], in raster coordinates
        std::uint32_t first_corner = 0; ///< into corner_high and corner_low
        std::uint32_t corner_count = 0;
        std::uint32_t corner_slots = 0;
        /// 3 or 4: it can be drawn as one outline with so many sides. 0: its corners do not lie in straight
        /// rows, and it is drawn triangle by triangle.
        std::uint32_t sides = 0;
        std::array<std::uint32_t, 4> side_begin{}; ///< corner that a side begins at, from 0; ascending
        float bend = 0.0f; ///< how far corners lie off their sides, raster coordinates
    };
    std::vector<GridPolygon> grid_polygons; ///< group by group
    std::vector<GridMap> grid_maps;         ///< of the grid polygons
    /// Corners of the grid polygons: x, y, z; the last one again up to a multiple of corner_slots.
    std::array<CacheLineVector<float>, 3> corner_high;
    std::array<CacheLineVector<float>, 3> corner_low;
    std::vector<double> corner_along; ///< where each lies on its side, from 0 to 1; of polygons with sides

    /// Grid polygons that lie near one another.
    struct PolygonGroup {
        std::uint32_t first; ///< into grid_polygons
        std::uint32_t count;
    };
    std::vector<PolygonGroup> groups;

    /// What is culled as a whole: the groups, and after them the clusters.
    [[nodiscard]] std::uint32_t parts() const noexcept {
        return static_cast<std::uint32_t>(groups.size() + clusters.size());
    }
    /// Spheres round the parts, in raster coordinates: x, y and z of the centres, and radii. A multiple of 16
    /// elements, those beyond parts() with a radius below 0 that nothing reaches.
    std::array<CacheLineVector<float>, 4> spheres;
    /// Half the edges of boxes along the axes that hold the parts, about the same centres.
    std::vector<std::array<float, 3>> extents;

    /// Whether a part holds whole polygons.
    [[nodiscard]] bool is_whole(std::uint32_t part) const {
        return part < groups.size() || clusters[part - groups.size()].whole;
    }
    /// Polygons of a part, ascending, each once.
    [[nodiscard]] std::vector<std::uint32_t> polygons_of(std::uint32_t part) const;

    /// Adds the bounds of a part that has these vertices, in scene units.
    void add_bounds(std::span<const Vec3> vertices);

private:
    void add_groups();
    void add_groups(std::span<GridPolygon> polygons);
};

} // namespace hemi
