#include "hemi/core/error.hpp"
#include "hemi/pipeline/heat.hpp"
#include "pipeline/heat_rows.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hemi {

namespace {

double emissivity_of(const HeatProblem& problem, const HeatSolution& solution, std::uint32_t i,
                     std::uint32_t band) {
    const std::uint32_t table = problem.table_of[i];
    return table == no_heat || std::isnan(solution.temperature[i])
               ? problem.emissivity[std::size_t{i} * problem.bands + band]
               : emissivity_at(problem.tables[table], solution.temperature[i]);
}

} // namespace

Solution heat_as_solution(const FormFactors& factors, const HeatProblem& problem,
                          const HeatSolution& solution, std::uint32_t channels) {
    const std::uint32_t bands = problem.bands;
    const std::uint32_t size = factors.matrix.size();
    if (channels != bands && bands != 1) {
        throw InvalidArgument(fmt::format("heat of {} bands as {} channels", bands, channels));
    }
    if (solution.radiosity.size() != std::size_t{size} * bands || solution.net_flux.size() != size) {
        throw InvalidArgument("heat of other patches than those of the form factors");
    }
    Solution result;
    result.channels = channels;
    result.temperature = solution.temperature;
    result.net_flux = solution.net_flux;
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
            const std::uint32_t band = bands == 1 ? 0 : c;
            const std::size_t k = std::size_t{i} * bands + band;
            result.radiosity.push_back(solution.radiosity[k]);
            result.irradiance.push_back(solution.irradiation[k]);
            result.exitance.push_back(solution.radiosity[k] -
                                      (1.0 - emissivity_of(problem, solution, i, band)) *
                                          solution.irradiation[k]);
            if (!problem.direct.empty()) {
                result.direct.push_back(problem.direct[k]);
            }
        }
        const RowView row = factors.matrix.row(i);
        result.row_sum.push_back(row.sum());
        result.environment_share.push_back(row.environment);
        result.back_face_share.push_back(row.blocked);
    }
    return result;
}

Scene scene_of_heat(Scene scene, const HeatProblem& problem) {
    scene.environment = environment_exitance(problem);
    scene.environment.resize(scene.channels.size(), scene.environment.front());
    scene.thermal = Thermal{problem.band_limits, {}, std::nullopt};
    for (Surface& surface : scene.surfaces) {
        surface.heat = no_heat;
    }
    return scene;
}

} // namespace hemi
