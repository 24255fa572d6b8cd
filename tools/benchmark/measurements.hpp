#pragma once

#include "benchmark/cases.hpp"
#include "benchmark/report.hpp"
#include "benchmark/timing.hpp"
#include "hemi/engine/engine.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace hemi::bench {

/// What is measured, on which device, and how long.
struct Setup {
    std::string device; ///< of OpenGL
    std::filesystem::path worker_program;
    bool software = true;      ///< OpenGL; figures that say what the CPU reaches have an aim there alone
    std::uint32_t workers = 1; ///< processes
    Effort effort{0.5, 3};
    std::uint64_t seed = 0;
};

/// What naive and engine rows may differ by and still be the same work, of a row.
inline constexpr double most_difference = 2e-3;

/// Lines of the report, each timed when it is asked for.
class Measurements {
public:
    Measurements(Setup setup, Report& report) : setup_(std::move(setup)), report_(report) {}

    /// Compares naive and engine rows, then times the case at every resolution.
    /// @throws Error if the rows differ by more than most_difference
    void table(const Case& scene);

    /// One core each, room of `patches` patches, resolution 128. Compares the rows first.
    void naive_target(std::uint32_t patches, double least_ratio);
    /// What a row of the room of `many` patches costs, over one of `few`.
    void growth_target(std::uint32_t few, std::uint32_t many, double most_ratio);
    void workers_target(std::uint32_t patches, double least_ratio);
    void scene_rate(const Case& scene);
    void merging_target(const Case& scene, double least_ratio);
    /// Wall time of `hemi factors MESH --device cpu` by the default preset: everything is computed, nothing
    /// written.
    /// @param most_seconds       0: no aim
    /// @param least_over_osmesa  speed over `--device osmesa`, which takes minutes; 0: that is not run
    void factors_target(const std::filesystem::path& hemi, const std::filesystem::path& mesh, unsigned runs,
                        double most_seconds, double least_over_osmesa);
    /// Wall time of `hemi solve SCENE --preset PRESET --device auto -o PICTURE`.
    void solve_target(const std::filesystem::path& hemi, const std::filesystem::path& scene,
                      const std::string& preset, unsigned runs, double most_seconds);

    /// The CPU rasteriser against Embree's coherent packets and OpenGL, one core each. Compares the rows
    /// first.
    void cpu_target(const Case& scene, std::uint32_t resolution, double least_over_embree,
                    double least_over_gl);
    /// The CPU rasteriser alone: rows by all cores, and what a second thread brings.
    void cpu_rates(const Case& scene, std::uint32_t resolution, double least_rate, double least_ratio);
    /// What a row of `many` costs on the CPU rasteriser, over one of `few`.
    void cpu_growth_target(const Case& few, const Case& many, std::uint32_t resolution, double most_ratio);

private:
    [[nodiscard]] HemicubeSettings settings(std::uint32_t resolution) const;
    [[nodiscard]] Bound software_bound() const { return setup_.software ? Bound::at_least : Bound::none; }
    /// @param workers  processes; 0: one context of this process
    [[nodiscard]] std::unique_ptr<RowProvider> engine(const Case& scene, const HemicubeSettings& settings,
                                                      std::uint32_t workers) const;
    /// Rows for comparing engines on a scene: what `single` computes in a run, or enough for all workers.
    [[nodiscard]] std::vector<std::uint32_t> rows_for(RowProvider& single,
                                                      std::uint32_t blocks_a_worker) const;
    [[nodiscard]] std::unique_ptr<RowProvider> cpu_engine(const Case& scene, std::uint32_t resolution,
                                                          std::uint32_t threads) const;
    [[nodiscard]] Subject subject(RowProvider& provider, std::vector<std::uint32_t> rows) const;
    void compare_rows(const Case& scene);
    [[nodiscard]] Cell cell(const Case& scene, std::uint32_t resolution) const;
    void growth(std::uint32_t workers, const Case& few, const Case& many, double most_ratio);

    Setup setup_;
    Report& report_;
};

} // namespace hemi::bench
