#include "pipeline/group_importance.hpp"

#include <algorithm>

namespace hemi {

namespace {

// Errors of errors: a few per cent are little.
constexpr double tolerance = 0.02;
// Fields that are solved together.
constexpr std::uint32_t most_columns = 16;

} // namespace

GroupImportance::GroupImportance(const FormFactors& factors, std::span<const double> reflectance,
                                 std::uint32_t channels, const Progress& progress)
    : groups_(static_cast<std::uint32_t>(factors.groups.size())), channels_(channels) {
    const std::uint32_t size = factors.matrix.size();
    const std::size_t columns = std::size_t{groups_} * channels_;
    values_.resize(size * columns);
    const std::uint32_t at_once = std::max(1u, most_columns / channels_);
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
        RadiosityProblem problem;
        problem.factors = &factors.matrix;
        problem.channels = width;
        problem.reflectance = rho;
        problem.exitance = source;
        problem.areas = factors.areas;
        SolverSettings settings;
        settings.tolerance = tolerance;
        settings.watch = [&](std::uint32_t, double, const auto&) { return progress(first, groups_); };
        const Solution solved = solve_radiosity(problem, settings);
        for (std::uint32_t i = 0; i < size; ++i) {
            std::copy_n(solved.radiosity.begin() + static_cast<std::ptrdiff_t>(std::size_t{i} * width), width,
                        values_.begin() +
                            static_cast<std::ptrdiff_t>(i * columns + std::size_t{first} * channels_));
        }
    }
}

std::uint64_t GroupImportance::memory_bytes(std::uint64_t patches, std::uint64_t groups,
                                            std::uint64_t channels) {
    constexpr std::uint64_t fields = 20; // of conjugate gradients, see solve_radiosity()
    const std::uint64_t width = std::max<std::uint64_t>(most_columns, channels);
    return sizeof(double) * patches * (groups * channels + fields * width);
}

} // namespace hemi
