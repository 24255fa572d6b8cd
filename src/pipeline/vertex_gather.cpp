#include "hemi/pipeline/vertex_gather.hpp"

#include "display/smooth_surfaces.hpp"
#include "display/vertex_colours_detail.hpp"

#include "core/parallel_for.hpp"
#include "engine/clusters/cluster_tree.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "pipeline/gathered_radiosity.hpp"
#include "pipeline/point_daylight.hpp"
#include "pipeline/row_computation.hpp"
#include "pipeline/visible_radiosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t no_point = 0xFFFFFFFFu;
/// Of a corner whose value needs no point.
constexpr std::uint32_t known_point = 0xFFFFFFFEu;
/// A vertex on the rim of a surface is seen from so far within, as a share of the way to the middle of the
/// patches that meet there. On the rim itself, walls that stand on it have no definite factor. Chosen, not
/// fitted: far above rounding, and the field changes little over so short a way.
constexpr double inwards = 0.1;
/// Patches whose normals differ by less (one minus the cosine) lie in one plane.
constexpr double flat = 1e-9;
/// One hemicube has as many texels as the four of a patch by the same preset.
constexpr std::uint32_t resolution_factor = 2;
/// Corners that differ from their patch by less are not worth a gather; see corners_differ().
constexpr double least_change = 2e-3;

/// With more patches a picture shows most in a few pixels each: they are not worth a gather by itself.
constexpr std::uint32_t most_gathered = 250'000;

/// Rows that are kept: those of all points, one after the other.
struct KeptRows {
    std::vector<std::vector<std::uint32_t>> columns;
    std::vector<std::vector<float>> values;
    std::vector<double> environment;
    std::vector<double> blocked;
    std::uint64_t bytes = 0;
};

/// Whether the radiosity of patches and of their corners differs.
bool corners_differ(const PatchMesh& mesh, const Solution& solution) {
    const std::uint32_t channels = solution.channels;
    const std::vector<float> corners =
        corner_values(mesh, channels, solution.radiosity, solution.back_face_share);
    for (std::uint32_t c = 0; c < channels; ++c) {
        double change = 0.0;
        double reflected = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            if (is_covered(solution.back_face_share, i)) {
                continue;
            }
            const std::size_t at = std::size_t{i} * channels + c;
            reflected += mesh.areas()[i] * std::pow(solution.radiosity[at] - solution.exitance[at], 2.0);
            const std::uint32_t count = mesh.corners(i).count;
            for (std::uint32_t k = 0; k < count; ++k) {
                const auto corner = static_cast<double>(corners[(std::size_t{i} * 4 + k) * channels + c]);
                change += mesh.areas()[i] * std::pow(corner - solution.radiosity[at], 2.0) / count;
            }
        }
        if (change > least_change * least_change * reflected) {
            return true;
        }
    }
    return false;
}

} // namespace

struct VertexGather::State {
    State(const PatchMesh& the_mesh, std::span<const double> the_blocked,
          std::span<const std::uint32_t> patches, KnownCorners the_known)
        : mesh(the_mesh), surfaces(the_mesh), blocked(the_blocked.begin(), the_blocked.end()),
          near(patches_near_surfaces(the_mesh)), point_of(std::size_t{the_mesh.size()} * 4, no_point),
          known(std::move(the_known)) {
        std::map<std::vector<std::uint32_t>, std::uint32_t> found; // patches that meet, of one vertex
        std::vector<std::vector<std::uint32_t>> corners_at(surfaces.vertex_count());
        for (const std::uint32_t patch : patches) {
            if (!is_covered(blocked, patch)) {
                const auto ring = surfaces.corners(patch);
                for (std::uint32_t k = 0; k < ring.size(); ++k) {
                    corners_at[ring[k]].push_back(patch * 4 + k);
                }
            }
        }
        add_ends_of_edges(corners_at);
        drop_hanging(corners_at);
        keep_known(corners_at);
        for (std::uint32_t vertex = 0; vertex < corners_at.size(); ++vertex) {
            found.clear();
            for (const std::uint32_t corner : corners_at[vertex]) {
                std::vector<std::uint32_t> meeting = patches_around(corner / 4, vertex);
                const auto [entry, is_new] =
                    found.try_emplace(std::move(meeting), static_cast<std::uint32_t>(points.size()));
                if (is_new) {
                    add_point(surfaces.position(vertex), entry->first);
                }
                point_of[corner] = entry->second;
            }
        }
    }

    /// Makes the clusters of a large scene, lamps apart.
    void find_clusters(const PatchValues& values) {
        if (mesh.size() <= points_ask_singly || mesh.symmetry()) {
            return;
        }
        std::vector<double> seen_areas(mesh.areas().begin(), mesh.areas().end());
        for (std::uint32_t i = 0; i < blocked.size(); ++i) { // not what lies buried
            seen_areas[i] *= std::max(0.0, 1.0 - blocked[i]);
        }
        tree.emplace(mesh, emitting_patches(mesh.size(), values.exitance));
        clusters = std::make_shared<SourceClusters>(tree->clusters()->with_weights(seen_areas));
    }

    /// Adds the corners between which the values of vertices in the middle of an edge are interpolated.
    /// @param corners_at  corner k of patch i as i·4 + k, of every vertex
    void add_ends_of_edges(std::vector<std::vector<std::uint32_t>>& corners_at) const {
        const auto hanging = surfaces.hanging();
        // Those of short edges first: their ends may lie in the middle of longer ones.
        for (auto entry = hanging.rbegin(); entry != hanging.rend(); ++entry) {
            const auto& here = corners_at[entry->vertex];
            const bool depends = std::any_of(here.begin(), here.end(), [&](std::uint32_t corner) {
                return surfaces.continues_at(entry->vertex, entry->patch, corner / 4);
            });
            if (!depends || is_covered(blocked, entry->patch)) {
                continue;
            }
            const auto ring = surfaces.corners(entry->patch);
            for (std::uint32_t k = 0; k < ring.size(); ++k) {
                auto& corners = corners_at[ring[k]];
                const std::uint32_t corner = entry->patch * 4 + k;
                if ((ring[k] == entry->from || ring[k] == entry->to) &&
                    std::find(corners.begin(), corners.end(), corner) == corners.end()) {
                    corners.push_back(corner);
                }
            }
        }
    }

    /// Takes out the corners that show what a longer edge does, whatever they would gather.
    void drop_hanging(std::vector<std::vector<std::uint32_t>>& corners_at) const {
        for (const SmoothSurfaces::Hanging& hanging : surfaces.hanging()) {
            std::erase_if(corners_at[hanging.vertex], [&](std::uint32_t corner) {
                return surfaces.continues_at(hanging.vertex, hanging.patch, corner / 4);
            });
        }
    }

    /// Takes out the corners whose values are known already.
    void keep_known(std::vector<std::vector<std::uint32_t>>& corners_at) {
        if (known.values.empty()) {
            return;
        }
        std::vector<bool> is_unknown(corners_at.size(), false);
        for (const std::uint32_t patch : known.unknown) {
            for (const std::uint32_t vertex : surfaces.corners(patch)) {
                is_unknown[vertex] = true;
            }
        }
        for (std::uint32_t vertex = 0; vertex < corners_at.size(); ++vertex) {
            if (!is_unknown[vertex]) {
                for (const std::uint32_t corner : corners_at[vertex]) {
                    point_of[corner] = known_point;
                }
                corners_at[vertex].clear();
            }
        }
    }

    /// Uncovered patches that meet at a vertex and continue one of them.
    [[nodiscard]] std::vector<std::uint32_t> patches_around(std::uint32_t patch, std::uint32_t vertex) const {
        std::vector<std::uint32_t> meeting;
        for (const std::uint32_t other : surfaces.patches_at(vertex)) {
            if (!is_covered(blocked, other) && surfaces.continues_at(vertex, patch, other)) {
                meeting.push_back(other);
            }
        }
        return meeting;
    }

    void add_point(const Vec3& vertex, const std::vector<std::uint32_t>& meeting) {
        std::uint32_t largest = meeting[0];
        Vec3 normal(0.0);
        Vec3 middle(0.0);
        for (const std::uint32_t patch : meeting) {
            largest = mesh.areas()[patch] > mesh.areas()[largest] ? patch : largest;
            normal += mesh.areas()[patch] * mesh.normal(patch);
            middle += mesh.centres()[patch] / static_cast<double>(meeting.size());
        }
        const Vec3 own = mesh.normal(largest);
        const bool in_one_plane = std::all_of(meeting.begin(), meeting.end(), [&](std::uint32_t patch) {
            return glm::dot(mesh.normal(patch), own) > 1.0 - flat;
        });
        // A point of a curved surface lies on one of its patches, since between them it would be inside.
        const Vec3 within = in_one_plane ? middle : mesh.centres()[largest];
        points.push_back({vertex + inwards * (within - vertex), in_one_plane ? own : glm::normalize(normal),
                          mesh.surface_of()[largest]});
        hosts.push_back(largest);
    }

    /// Radiosity of what can be seen of the columns of rows.
    [[nodiscard]] std::vector<double> visible(const PatchValues& values,
                                              std::span<const double> radiosity) const {
        std::vector<double> seen =
            visible_radiosity(mesh, surfaces, near, values.channels, radiosity, values.exitance, blocked);
        if (clusters) {
            seen.resize((mesh.size() + clusters->nodes().size()) * values.channels);
            clusters->fill(seen, values.channels);
        }
        return seen;
    }

    void check(const PatchValues& values, std::span<const double> radiosity) const {
        const std::size_t count = std::size_t{mesh.size()} * values.channels;
        if (radiosity.size() != count || values.reflectance.size() != count ||
            values.exitance.size() != count ||
            (!values.environment.empty() && values.environment.size() != values.channels) ||
            (!known.values.empty() && known.values.size() != 4 * count)) {
            throw InvalidArgument(fmt::format("gather: {} values for {} patches of {} channels",
                                              radiosity.size(), mesh.size(), values.channels));
        }
    }

    /// Adds what a point reflects of sun and sky.
    void add_direct(const PointDaylight& daylight, std::size_t point, const RowView& row,
                    const PatchValues& values, std::span<float> light) const {
        const SurfacePoint& at = points[point];
        const PointDaylight::Environment seen =
            daylight.has_sky() ? daylight.seen_by(at.position, at.normal, row) : PointDaylight::Environment{};
        const double* const rho = &values.reflectance[std::size_t{hosts[point]} * values.channels];
        daylight.irradiance(at.position, at.normal, seen, [&](std::uint32_t c, double irradiance) {
            light[c] += static_cast<float>(rho[c] * irradiance);
        });
    }

    /// Values of the points as values of all corners.
    [[nodiscard]] std::vector<float> corners(const std::vector<float>& at_points,
                                             const std::vector<std::uint8_t>& buried, std::uint32_t channels,
                                             std::span<const double> radiosity) const {
        GivenCorners given;
        given.values.assign(point_of.size() * channels, 0.0F);
        given.kinds.assign(point_of.size(), GivenCorners::Kind::mean);
        for (std::size_t corner = 0; corner < point_of.size(); ++corner) {
            const std::uint32_t point = point_of[corner];
            if (point == no_point) {
                continue;
            }
            if (point == known_point) {
                given.kinds[corner] = GivenCorners::Kind::given;
                std::copy_n(known.values.begin() + static_cast<std::ptrdiff_t>(corner * channels), channels,
                            given.values.begin() + static_cast<std::ptrdiff_t>(corner * channels));
                continue;
            }
            given.kinds[corner] =
                buried[point] != 0 ? GivenCorners::Kind::unknown : GivenCorners::Kind::given;
            std::copy_n(at_points.begin() + static_cast<std::ptrdiff_t>(std::size_t{point} * channels),
                        channels, given.values.begin() + static_cast<std::ptrdiff_t>(corner * channels));
        }
        return corner_values(mesh, surfaces, channels, radiosity, blocked, given);
    }

    const PatchMesh& mesh;
    SmoothSurfaces surfaces;
    std::vector<double> blocked;
    std::vector<std::uint32_t> near;     ///< patches that have a surface near in front of them
    std::vector<std::uint32_t> point_of; ///< of corner k of patch i at [i·4 + k]
    std::vector<SurfacePoint> points;
    std::vector<std::uint32_t> hosts; ///< patch that each point lies on
    std::optional<ClusterTree> tree;  ///< of large scenes: what is far stands in clusters
    std::shared_ptr<const SourceClusters> clusters;
    KeptRows kept;
    KnownCorners known;
};

VertexGather::VertexGather(const PatchMesh& mesh, std::span<const double> blocked,
                           std::span<const std::uint32_t> patches, KnownCorners known)
    : state_(std::make_unique<State>(mesh, blocked, patches, std::move(known))) {}
VertexGather::~VertexGather() = default;
VertexGather::VertexGather(VertexGather&&) noexcept = default;
VertexGather& VertexGather::operator=(VertexGather&&) noexcept = default;

std::span<const SurfacePoint> VertexGather::points() const {
    return state_->points;
}

std::vector<float> VertexGather::compute(const PatchValues& values, std::span<const double> radiosity,
                                         const FactorSettings& settings, Enclosure enclosure,
                                         std::uint64_t keep_bytes, Observer& observer) {
    State& state = *state_;
    state.check(values, radiosity);
    state.find_clusters(values);
    const std::vector<double> seen = state.visible(values, radiosity);
    state.kept = {};
    KeptRows kept; // the state's when all are there
    const std::uint32_t channels = values.channels;
    std::vector<float> at_points(state.points.size() * channels, 0.0F);
    std::vector<std::uint8_t> buried(state.points.size(), 0);
    if (!state.points.empty()) {
        RowPlan plan = plan_rows(settings, state.mesh.size());
        plan.hemicube.joint = state.tree.has_value();
        if (plan.hemicube.eye_points > 1) {
            plan.hemicube.resolution *= resolution_factor;
        }
        std::vector<double> weights(state.mesh.size());
        for (std::uint32_t j = 0; j < state.mesh.size(); ++j) {
            weights[j] = *std::max_element(radiosity.begin() + std::ptrdiff_t{j} * channels,
                                           radiosity.begin() + (std::ptrdiff_t{j} + 1) * channels);
        }
        bool keep = keep_bytes > 0;
        if (keep) {
            kept.columns.resize(state.points.size());
            kept.values.resize(state.points.size());
            kept.environment.resize(state.points.size());
            kept.blocked.resize(state.points.size());
        }
        const auto engine = make_point_visibility_provider(state.mesh, state.points, plan.hemicube, settings);
        const PointDaylight daylight(state.mesh, values.sun, values.sky, values.up, state.clusters);
        compute_point_rows(
            *engine, state.mesh, state.points, plan.weighted.value_or(VisibilityWeightedSettings{}),
            enclosure, weights,
            [&](std::uint32_t index, const RowView& row) {
                const auto light = std::span(at_points).subspan(std::size_t{index} * channels, channels);
                gathered_radiosity(row, values, seen, state.hosts[index], light);
                state.add_direct(daylight, index, row, values, light);
                buried[index] = row.blocked > buried_above ? 1 : 0;
                if (!keep) {
                    return;
                }
                kept.bytes += row.columns.size() * (sizeof(std::uint32_t) + sizeof(float));
                if (kept.bytes > keep_bytes) {
                    keep = false;
                    kept = {};
                    return;
                }
                kept.columns[index].assign(row.columns.begin(), row.columns.end());
                kept.values[index].assign(row.values.begin(), row.values.end());
                kept.environment[index] = row.environment;
                kept.blocked[index] = row.blocked;
            },
            [&observer](std::size_t done, std::size_t total) {
                return observer.progress(Phase::gather, done, total);
            },
            {.clusters = state.tree ? &*state.tree : nullptr});
    }
    state.kept = std::move(kept);
    return state.corners(at_points, buried, channels, radiosity);
}

bool VertexGather::has_rows() const {
    return !state_->kept.columns.empty() || state_->points.empty();
}

std::vector<float> VertexGather::gather(const PatchValues& values, std::span<const double> radiosity) const {
    const State& state = *state_;
    state.check(values, radiosity);
    if (!has_rows()) {
        throw InvalidArgument("gather: no rows were kept");
    }
    const std::vector<double> seen = state.visible(values, radiosity);
    const std::uint32_t channels = values.channels;
    std::vector<float> at_points(state.points.size() * channels, 0.0F);
    std::vector<std::uint8_t> buried(state.points.size(), 0);
    const PointDaylight daylight(state.mesh, values.sun, values.sky, values.up, state.clusters);
    constexpr std::size_t points_at_once = 64;
    parallel_for(state.points.size(), points_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const RowView row{state.kept.columns[k],
                              state.kept.values[k],
                              {},
                              state.kept.environment[k],
                              state.kept.blocked[k]};
            const auto light = std::span(at_points).subspan(k * channels, channels);
            gathered_radiosity(row, values, seen, state.hosts[k], light);
            state.add_direct(daylight, k, row, values, light);
            buried[k] = row.blocked > buried_above ? 1 : 0;
        }
    });
    return state.corners(at_points, buried, channels, radiosity);
}

bool should_gather(Gather wanted, const FactorSettings& settings, const PatchMesh& mesh,
                   const Solution& solution) {
    if (wanted != Gather::automatic) {
        return wanted == Gather::on;
    }
    return settings.method == Method::hemicube && settings.preset != Preset::plain &&
           settings.preset != Preset::fast && mesh.size() <= most_gathered && corners_differ(mesh, solution);
}

void gather_at_vertices(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings,
                        Gather wanted, Solution& solution, Observer& observer, KnownCorners known) {
    gather_at_vertices(mesh, patch_values(scene, mesh), scene.enclosure, settings, wanted, solution, observer,
                       std::move(known));
}

void gather_at_vertices(const PatchMesh& mesh, const PatchValues& values, Enclosure enclosure,
                        const FactorSettings& settings, Gather wanted, Solution& solution, Observer& observer,
                        KnownCorners known) {
    solution.vertex_radiosity.clear();
    if (!should_gather(wanted, settings, mesh, solution)) {
        return;
    }
    const Stopwatch watch;
    std::vector<std::uint32_t> reflecting;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const auto own =
            std::span(values.reflectance).subspan(std::size_t{i} * values.channels, values.channels);
        if (std::any_of(own.begin(), own.end(), [](double rho) { return rho > 0.0; })) {
            reflecting.push_back(i);
        }
    }
    VertexGather gather(mesh, solution.back_face_share, reflecting, std::move(known));
    solution.vertex_radiosity = gather.compute(values, solution.radiosity, settings, enclosure, 0, observer);
    observer.detail(fmt::format("gathered at {} vertices in {}", count_text(gather.points().size()),
                                seconds_text(watch.seconds())));
}

} // namespace hemi
