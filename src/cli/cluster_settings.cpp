#include "cli/cluster_settings.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/expansion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

std::optional<ClusterObstacle> obstacle_of_rows(const RowOptions& rows) {
    const FactorSettings& settings = rows.factors;
    if (settings.preset == Preset::plain || settings.method != Method::hemicube) {
        return {{"--preset plain and --method", "since clusters are made of visibility"}};
    }
    if (settings.repair && *settings.repair != Repair::none) {
        return {{"--repair", "which needs the pairs of patches"}};
    }
    if (settings.shadow_rays && *settings.shadow_rays > 0) {
        return {{"--shadow-rays", "which are those of single pairs"}};
    }
    return std::nullopt;
}

} // namespace

std::optional<ClusterObstacle> obstacle_of_solver(const SolverSettings& solver) {
    if (solver.method == SolverMethod::conjugate_gradient) {
        return {{"--solver cg", "which needs reciprocal rows"}};
    }
    return std::nullopt;
}

void settle_clusters(const CommonOptions& common, RowOptions& rows, std::optional<ClusterObstacle> more) {
    Clusters& clusters = rows.factors.clusters;
    const auto obstacle = more ? more : obstacle_of_rows(rows);
    if (obstacle && clusters == Clusters::on) {
        throw InvalidArgument(
            fmt::format("--clusters on excludes {}, {}; leave one out", obstacle->option, obstacle->why));
    }
    if ((obstacle || clusters == Clusters::off) &&
        std::find(common.given.begin(), common.given.end(), "--cluster-error") != common.given.end()) {
        throw InvalidArgument(
            fmt::format("--cluster-error has no effect with {}: no clusters are made; leave one out",
                        obstacle ? obstacle->option : "--clusters off"));
    }
    if (obstacle) {
        clusters = Clusters::off;
    }
}

void expand_clusters(FormFactors& factors, const std::filesystem::path& target, std::uint64_t max_memory,
                     Diagnostics& diagnostics) {
    if (factors.matrix.clusters() == nullptr) {
        return;
    }
    try {
        factors.matrix = hemi::expand_clusters(factors.matrix, max_memory);
    } catch (const OutOfMemory& error) {
        throw OutOfMemory(fmt::format("{}: {}", target.string(), error.what()), error.settings());
    }
    diagnostics.note(
        fmt::format("{}: factors to clusters are shared out among their patches by area", target.string()));
}

void refuse_clusters(const FormFactors& factors, const std::filesystem::path& path, std::string_view need) {
    if (factors.matrix.clusters() != nullptr) {
        throw InputError(fmt::format("{}: far patches stand in clusters, but {} needs factors of single "
                                     "patches; make the rows with --clusters off",
                                     path.string(), need));
    }
}

} // namespace hemi::cli
