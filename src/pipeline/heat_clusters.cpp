#include "hemi/matrix/product.hpp"
#include "pipeline/heat_rows.hpp"

#include <cmath>

namespace hemi {

std::vector<double> asymmetry_errors(const FormFactors& factors, const HeatProblem& problem,
                                     const HeatSolution& solution) {
    const std::size_t groups = factors.groups.size();
    std::vector<double> gaps(groups + 1, 0.0);
    if (factors.matrix.clusters() == nullptr) {
        return gaps;
    }
    const std::uint32_t size = factors.matrix.size();
    const std::uint32_t bands = problem.bands;
    const std::uint32_t columns = bands + 1; // radiosities, and 1 where there are any
    std::vector<double> leaving(std::size_t{size} * columns, 0.0);
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t k = 0; k < columns && solution.buried[i] == 0; ++k) {
            leaving[std::size_t{i} * columns + k] =
                k < bands ? solution.radiosity[std::size_t{i} * bands + k] : 1.0;
        }
    }
    std::vector<double> arriving(leaving.size());
    multiply(factors.matrix, leaving, columns, arriving);
    const std::vector<double> environment = shares_of_environment(factors);
    const std::vector<double> bright = environment_exitance(problem);
    std::vector<double> areas(groups + 1, 0.0);
    for (std::uint32_t i = 0; i < size; ++i) {
        if (solution.buried[i] != 0) {
            continue;
        }
        // What the row lacks comes back, as in the network.
        const double* const of_row = arriving.data() + std::size_t{i} * columns;
        const double back = 1.0 - of_row[bands] - environment[i];
        double gap = 0.0;
        for (std::uint32_t k = 0; k < bands; ++k) {
            const std::size_t at = std::size_t{i} * bands + k;
            const double direct = problem.direct.empty() ? 0.0 : problem.direct[at];
            gap += solution.irradiation[at] -
                   (of_row[k] + back * solution.radiosity[at] + environment[i] * bright[k] + direct);
        }
        for (const std::size_t g : {std::size_t{factors.group_of[i]}, groups}) {
            gaps[g] += factors.areas[i] * gap;
            areas[g] += factors.areas[i];
        }
    }
    for (std::size_t g = 0; g <= groups; ++g) {
        gaps[g] = areas[g] > 0.0 ? std::abs(gaps[g]) / areas[g] : 0.0;
    }
    return gaps;
}

} // namespace hemi
