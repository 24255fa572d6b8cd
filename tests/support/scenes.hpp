#pragma once

#include "hemi/matrix/balance.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <string>
#include <vector>

namespace hemi::test {

/// A scene of one grey material (reflectance 0.5), filled with the functions below.
[[nodiscard]] Scene empty_scene();
/// Adds a polygon; its group is made if it is new.
void add_polygon(Scene& scene, const std::string& group, std::vector<Vec3> polygon, Grid patches = {1, 1});
/// Adds an axis-aligned box, faces outward, groups all `group`; or a room, faces inward, groups x0 … z1.
void add_block(Scene& scene, const std::string& group, const Vec3& lower, const Vec3& upper,
               std::uint32_t cells);
void add_room(Scene& scene, const Vec3& lower, const Vec3& upper, std::uint32_t cells);

/// Closed room 1.2 x 1.0 x 0.8 with one block on the floor and one turned block in the air.
[[nodiscard]] Scene room_with_blocks(std::uint32_t cells);
/// Whether a point of the floor lies under the standing block of room_with_blocks.
[[nodiscard]] bool under_block(const Vec3& point);
/// Closed box whose side walls are trapezia, with bilinear cells.
[[nodiscard]] Scene tapered_box(std::uint32_t cells);
/// Closed room of walls that are lattices of quadrilaterals and of triangle pairs, one patch each.
[[nodiscard]] Scene lattice_room();
/// Closed room whose ceiling is cut into strips that meet uncut walls in T-junctions.
[[nodiscard]] Scene t_junction_room();
/// Two closed unit rooms on either side of a partition of two back-to-back sheets; the ceiling of one is cut
/// in the middle of the partition's upper edge.
[[nodiscard]] Scene two_rooms();
/// Three walls that meet in a corner, open otherwise.
[[nodiscard]] Scene open_corner();
/// Unit floor and unit wall at a right angle; the wall as one polygon ("wall") or as "left" and "right".
[[nodiscard]] Scene two_plates(bool split);
/// A small patch and a square of edge `distance` facing it at that distance.
[[nodiscard]] Scene facing_square(double distance);

[[nodiscard]] Scene rotated(Scene scene);
[[nodiscard]] Scene scaled(Scene scene, double factor);
[[nodiscard]] Scene moved(Scene scene, const Vec3& by);
/// Surfaces in reverse order.
[[nodiscard]] Scene reversed(Scene scene);

/// Path of a file in tests/data.
[[nodiscard]] std::string data_path(const std::string& name);
/// One of the geometries with exact factors, tests/data/cases.
[[nodiscard]] Scene read_case(const std::string& file);

struct ExactCase {
    std::string name;
    std::string file;
    struct Pair {
        std::string from;
        std::string to;
        double factor;
    };
    std::vector<Pair> pairs;
    std::string title;              ///< for tables
    std::uint32_t patches_per_face; ///< 256; 4 for polyhedra of many faces
    /// What plain hemicubes stay within at that subdivision and resolution 256: each patch is sampled at one
    /// point, which costs accuracy where surfaces are near.
    double one_point_limit;
};
[[nodiscard]] std::vector<ExactCase> exact_cases();

/// group_factors() with names.
struct GroupTable {
    std::vector<std::string> names;
    GroupFactors factors;
    [[nodiscard]] double factor(const std::string& from, const std::string& to) const;
};
[[nodiscard]] GroupTable by_group(const PatchMesh& mesh, const FormFactorMatrix& factors);

} // namespace hemi::test
