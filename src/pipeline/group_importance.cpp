#include "pipeline/group_importance.hpp"

#include "pipeline/heat_rows.hpp"

#include <algorithm>
#include <functional>
#include <optional>

namespace hemi {

namespace {

// Errors of errors: a few per cent are little.
constexpr double tolerance = 0.02;
// Fields that are solved together, fewer of rows with clusters, see ExchangeProduct.
constexpr std::uint32_t most_columns = 16;
constexpr std::uint32_t most_columns_of_clusters = 4;

/// One or more fields w = h + rho F w, N·width.
std::vector<double> adjoint_by_rows(const FormFactors& factors, const std::vector<double>& rho,
                                    const std::vector<double>& source, std::uint32_t width,
                                    const std::function<bool()>& go_on) {
    RadiosityProblem problem;
    problem.factors = &factors.matrix;
    problem.channels = width;
    problem.reflectance = rho;
    problem.exitance = source;
    problem.areas = factors.areas;
    SolverSettings settings;
    settings.tolerance = tolerance;
    settings.watch = [&](std::uint32_t, double, const auto&) { return go_on(); };
    return solve_radiosity(problem, settings).radiosity;
}

/// The same by the symmetric exchange of clusters, whose rows alone tell what patches get, not what they
/// give.
std::vector<double> adjoint_by_network(const ExchangeNetwork& network, const std::vector<double>& rho,
                                       const std::vector<double>& source, std::uint32_t width,
                                       const std::function<bool()>& go_on) {
    NetworkSources sources;
    sources.columns = width;
    sources.source = source;
    sources.environment.assign(width, 0.0);
    for (const double value : rho) {
        sources.emissivity.push_back(1.0 - value);
    }
    return network.solve(sources, tolerance, [&](std::uint32_t, double) { return go_on(); }).radiosity;
}

} // namespace

GroupImportance::GroupImportance(const FormFactors& factors, std::span<const double> reflectance,
                                 std::uint32_t channels, const Progress& progress)
    : groups_(static_cast<std::uint32_t>(factors.groups.size())), channels_(channels) {
    const std::uint32_t size = factors.matrix.size();
    const std::size_t columns = std::size_t{groups_} * channels_;
    values_.resize(size * columns);
    std::optional<ExchangeNetwork> network;
    if (factors.matrix.clusters() != nullptr) {
        network.emplace(make_network(factors));
    }
    const std::uint32_t at_once =
        std::max(1u, (network ? most_columns_of_clusters : most_columns) / channels_);
    for (std::uint32_t first = 0; first < groups_; first += at_once) {
        const std::uint32_t groups = std::min(at_once, groups_ - first);
        const std::uint32_t width = groups * channels_;
        std::vector<double> rho(std::size_t{size} * width);
        std::vector<double> source(std::size_t{size} * width, 0.0);
        for (std::uint32_t i = 0; i < size; ++i) {
            for (std::uint32_t k = 0; k < width; ++k) {
                rho[std::size_t{i} * width + k] = reflectance[std::size_t{i} * channels_ + k % channels_];
            }
            if (const std::uint32_t g = factors.group_of[i]; g >= first && g < first + groups) {
                std::fill_n(source.begin() +
                                static_cast<std::ptrdiff_t>(std::size_t{i} * width + (g - first) * channels_),
                            channels_, 1.0);
            }
        }
        const auto go_on = [&] { return progress(first, groups_); };
        const std::vector<double> solved = network ? adjoint_by_network(*network, rho, source, width, go_on)
                                                   : adjoint_by_rows(factors, rho, source, width, go_on);
        for (std::uint32_t i = 0; i < size; ++i) {
            std::copy_n(solved.begin() + static_cast<std::ptrdiff_t>(std::size_t{i} * width), width,
                        values_.begin() +
                            static_cast<std::ptrdiff_t>(i * columns + std::size_t{first} * channels_));
        }
    }
}

void GroupImportance::add_columns(std::span<const std::uint32_t> parents, const SourceClusters* clusters) {
    if (clusters == nullptr || groups_ == 0) {
        return;
    }
    of_columns_.reserve((parents.size() + clusters->nodes().size()) * columns());
    for (const std::uint32_t parent : parents) {
        const std::span<const double> own = of(parent);
        of_columns_.insert(of_columns_.end(), own.begin(), own.end());
    }
    of_columns_.resize((parents.size() + clusters->nodes().size()) * columns());
    clusters->fill(of_columns_, columns());
}

std::uint64_t GroupImportance::memory_bytes(std::uint64_t patches, std::uint64_t groups,
                                            std::uint64_t channels) {
    constexpr std::uint64_t fields = 20; // of conjugate gradients, see solve_radiosity()
    const std::uint64_t width = std::max<std::uint64_t>(most_columns, channels);
    return sizeof(double) * patches * (groups * channels + fields * width);
}

} // namespace hemi
