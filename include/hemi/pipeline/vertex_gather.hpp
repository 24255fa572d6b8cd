#pragma once

#include "hemi/core/names.hpp"
#include "hemi/engine/point_rows.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hemi {

/// Radiosity at corners that needs no gather, since it hardly changed when other patches were cut.
struct KnownCorners {
    std::vector<float> values;          ///< as VertexGather::compute() gives them; empty: none is known
    std::vector<std::uint32_t> unknown; ///< patches whose corners are not known: vertices there are gathered
};

/// Radiosity at the corners of patches by a last gather: B(v) = E + rho sum_j F(v, j) B_j with a row of
/// factors of the corner's own, where a mean over the patches that meet there would smear what lies between
/// them, such as the edge of a shadow.
///
/// A row belongs to a vertex of a smooth surface (see corner_values()): patches that meet there and continue
/// each other share it. It is seen from the vertex or, on the rim of a surface, from a twentieth of a patch
/// within; on curved surfaces along the mean of the normals. Covered patches take no part, and vertices that
/// turn out to lie under something take what their neighbours have.
/// Memory: about 100 bytes a vertex; with kept rows 8 bytes an entry more.
/// Source: D. Lischinski, F. Tampieri, D. P. Greenberg, "Combining Hierarchical Radiosity and Discontinuity
/// Meshing", SIGGRAPH 1993 (a last gather at vertices); I. H. Sloan, "Improvement by iteration for compact
/// operator equations", Mathematics of Computation 30, 1976 (why it converges twice as fast).
class VertexGather {
public:
    /// @param mesh     N patches; must outlive this
    /// @param blocked  b_i of every patch: those that are covered do not count
    /// @param patches  whose corners are wanted, ascending; the corners of others keep their patches' means
    /// @param known    of them, what is not to be gathered
    VertexGather(const PatchMesh& mesh, std::span<const double> blocked,
                 std::span<const std::uint32_t> patches, KnownCorners known = {});
    ~VertexGather();
    VertexGather(VertexGather&&) noexcept;            ///< moves all
    VertexGather& operator=(VertexGather&&) noexcept; ///< moves all

    /// Where rows are seen from.
    [[nodiscard]] std::span<const SurfacePoint> points() const;

    /// Computes every row, uses it, and keeps it if it is to be kept.
    /// @param values     what patches reflect and radiate
    /// @param radiosity  B, N·channels
    /// @param settings   resolution, rule, shadow rays by the preset; device and workers
    /// @param enclosure  as the scene says
    /// @param keep_bytes rows are kept, for gather(), as long as they take less; 0: they are not
    /// @param observer   gets progress (Phase::gather) and may cancel
    /// @return B at corner k of patch i, channel c, at [(i·4 + k)·channels + c]; that of triangles has no k=3
    /// @throws InvalidArgument for values that do not fit; as make_point_visibility_engine(); Cancelled
    [[nodiscard]] std::vector<float> compute(const PatchValues& values, std::span<const double> radiosity,
                                             const FactorSettings& settings, Enclosure enclosure,
                                             std::uint64_t keep_bytes = 0,
                                             Observer& observer = no_observer());

    /// Whether the rows were kept.
    [[nodiscard]] bool has_rows() const;
    /// The same by the rows that were kept.
    /// @throws InvalidArgument for values that do not fit, or without rows
    [[nodiscard]] std::vector<float> gather(const PatchValues& values,
                                            std::span<const double> radiosity) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Whether the radiosity at corners is gathered.
enum class Gather {
    automatic, ///< where pictures gain by it, see gather_at_vertices()
    on,        ///< always
    off,       ///< never: corners have means over the patches that meet there
};

/// Words of Gather.
template <>
struct Names<Gather> {
    /// Every value with its word.
    static constexpr NamedValue<Gather> table[] = {
        {Gather::automatic, "auto"}, {Gather::on, "on"}, {Gather::off, "off"}};
};

/// Whether a solution is to be gathered. Automatic: by hemicubes of the presets `default` and `exact`, where
/// the radiosity differs between patches and their corners by 0.2 % (rms, of what is reflected, in the worst
/// channel) or more.
/// @param wanted    by the user
/// @param settings  preset and method
/// @param mesh      N patches
/// @param solution  radiosity, exitance and back-face shares are used
[[nodiscard]] bool should_gather(Gather wanted, const FactorSettings& settings, const PatchMesh& mesh,
                                 const Solution& solution);

/// Gathers the radiosity of a solution at the corners of the patches that reflect, into
/// Solution::vertex_radiosity, which is empty afterwards where it is not to be, see should_gather().
/// @param scene     materials and environment
/// @param mesh      its patches
/// @param settings  see VertexGather::compute()
/// @param wanted    by the user
/// @param solution  of the mesh
/// @param observer  gets progress and may cancel
/// @param known     corners that are not gathered
/// @throws as VertexGather::compute()
void gather_at_vertices(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings,
                        Gather wanted, Solution& solution, Observer& observer = no_observer(),
                        KnownCorners known = {});
/// The same for any values of the patches. Where they differ among the patches that meet at a vertex, those
/// of the largest count there.
/// @throws InvalidArgument too, for values that do not fit
void gather_at_vertices(const PatchMesh& mesh, const PatchValues& values, Enclosure enclosure,
                        const FactorSettings& settings, Gather wanted, Solution& solution,
                        Observer& observer = no_observer(), KnownCorners known = {});

} // namespace hemi
