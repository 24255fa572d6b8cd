#pragma once

#include "hemi/engine/row_provider.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// Settings that change the rows.
struct HemicubeSettings {
    std::uint32_t resolution = 128; ///< texels along a full hemicube edge; even, 2 to 4096
    std::uint64_t seed = 0;         ///< of the hashed rotation of every hemicube about its normal
    bool merge_lattices = true;     ///< draw lattices of coplanar parallelogram cells as one polygon
    /// Hemicubes a patch: 1, 4, 9 … 64; with 4 and more, up to four times as many on patches longer than
    /// twice their width.
    std::uint32_t eye_points = 1;
    /// Up to so many where a surface hovers close above a patch or stands on it; 1: none more.
    std::uint32_t near_eye_points = 1;
    /// Whether rows of visibility of one hemicube may tell of many patches by one number, see
    /// JointVisibility, which spares drawing what is hidden. The CPU rasteriser does; OpenGL tells of every
    /// patch.
    bool joint = false;

    bool operator==(const HemicubeSettings&) const = default; ///< member by member
};

/// Tests a number of eye points.
/// @throws InvalidArgument if `count` is not 1, 4, 9 … 64.
void check_eye_points(std::uint32_t count);

/// The device of hemi's own rasteriser: SIMD instructions in threads of this process, no OpenGL.
inline constexpr const char* cpu_device = "cpu";

/// Where and how rows are computed; none of it changes a bit of them on the same kind of device.
struct EngineSettings {
    std::string device = "auto"; ///< auto (a GPU if there is one, else cpu), cpu, egl, egl:N or osmesa
    /// Threads on `cpu`, worker processes on OpenGL; 0: one per core, on a GPU four at most.
    std::uint32_t jobs = 0;
    /// Program that is started for every worker, see find_worker_program(). Empty: rows are computed in this
    /// process, by one context.
    std::filesystem::path worker_program;
};

/// Form factors by hemicubes, whose item buffers are drawn by OpenGL or by the CPU rasteriser. Contexts are
/// made on the first call of rows() or renderer(). On `cpu`, rows come from `jobs` threads, in order; on
/// OpenGL from `jobs` worker processes where there is a worker program, else from one context of this
/// process.
/// @param mesh      must outlive the engine
/// @param settings  what changes the rows
/// @param engine    device and workers
/// @throws InvalidArgument for a bad resolution, number of eye points or device name; NoDevice if the
///   device is not there; GlError, or Error if a worker ends early or is of another build (then no row is
///   delivered in its place).
[[nodiscard]] std::unique_ptr<RowProvider>
make_hemicube_engine(const PatchMesh& mesh, const HemicubeSettings& settings, const EngineSettings& engine);

/// Visibility by the same hemicubes: for every patch j in view from i, the share of the delta form factors of
/// its texels that nothing hides. Parameters and errors as for make_hemicube_engine(). Of a mesh with
/// symmetry patches are those of ImageMesh::mesh(), whose images are not added up.
/// @see compute_visibility_weighted
[[nodiscard]] std::unique_ptr<VisibilityProvider>
make_visibility_engine(const PatchMesh& mesh, const HemicubeSettings& settings, const EngineSettings& engine);

/// Polygons that a hemicube draws: one for every lattice of coplanar parallelogram cells, if they are merged,
/// and one for every other patch.
/// @throws InvalidArgument if a surface is cut more than 65,535 ways along an edge
[[nodiscard]] std::size_t count_draw_polygons(const PatchMesh& mesh, bool merge_lattices);

/// The worker program that belongs to this library: what the environment variable HEMI_WORKER names, else
/// libexec/hemi/hemi-hemicube-worker in the folder of the running program (or of the shared library that hemi
/// is part of) or up to four folders above it, else where it was installed. Empty if it is in none of these
/// places.
[[nodiscard]] std::filesystem::path find_worker_program();

/// What the worker program does: serves rows to the process that started this one, until that closes the
/// connection.
/// @return exit status for main().
/// @throws InvalidArgument if there is no connection: the program was started by hand.
int run_hemicube_worker();

/// A device that can be chosen by name.
struct DeviceInfo {
    std::string name;     ///< "egl:0", "osmesa", "cpu"
    std::string renderer; ///< GL_RENDERER, empty if no context could be made; of `cpu` its instruction set
    std::string version;  ///< GL_VERSION; empty of `cpu`
    std::string problem;  ///< why it cannot be used; empty if it can
    bool software = true; ///< rasterises on the CPU
    bool chosen = false;  ///< what `auto` takes
};
/// Everything that could be used here; makes and destroys a context on each OpenGL device.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

/// A renderer without what does not change its rows: the instruction set of `cpu`.
[[nodiscard]] std::string renderer_of_rows(std::string_view renderer);

/// What made the loader of OpenGL's functions: "glad 2.0.2".
[[nodiscard]] std::string opengl_loader();

} // namespace hemi
