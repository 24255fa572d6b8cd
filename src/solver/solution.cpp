#include "hemi/solver/solution.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

std::vector<double> radiosity_errors(const Solution& solution) {
    if (!solution.error) {
        return {};
    }
    std::vector<double> errors = solution.error->patches;
    if (solution.patch_size_error && solution.patch_size_error->patches.size() == errors.size()) {
        std::transform(errors.begin(), errors.end(), solution.patch_size_error->patches.begin(),
                       errors.begin(), [](double a, double b) { return std::hypot(a, b); });
    }
    return errors;
}

} // namespace hemi
