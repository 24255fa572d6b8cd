#include "viewer/partners.hpp"

#include "hemi/matrix/product.hpp"

#include <algorithm>

namespace hemi::viewer {

std::vector<Partner> largest_partners(const ViewerInput& input, const Light& light, std::uint32_t picked,
                                      bool column, bool by_light, std::size_t count) {
    const FormFactorMatrix& factors = input.factors->matrix;
    std::vector<double> arriving(factors.size(), 0.0);
    double total = 0.0;
    visit_sources(factors, factors.row(picked), [&](std::uint32_t j, double factor) {
        double light_of_patch = 0.0;
        for (std::uint32_t c = 0; c < input.channels(); ++c) {
            light_of_patch += factor * light.radiosity[std::size_t{j} * input.channels() + c];
        }
        arriving[j] += light_of_patch;
        total += light_of_patch;
    });
    const std::vector<double> values = column ? factors_to(factors, picked) : factors_from(factors, picked);
    std::vector<Partner> partners;
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        if (values[j] > 0.0 || arriving[j] > 0.0) {
            partners.push_back({j, values[j], total > 0.0 ? arriving[j] / total : 0.0});
        }
    }
    const std::size_t kept = std::min(count, partners.size());
    std::partial_sort(partners.begin(), partners.begin() + static_cast<std::ptrdiff_t>(kept), partners.end(),
                      [by_light](const Partner& a, const Partner& b) {
                          const double x = by_light ? a.share : a.factor;
                          const double y = by_light ? b.share : b.factor;
                          return x != y ? x > y : a.patch < b.patch;
                      });
    partners.resize(kept);
    return partners;
}

} // namespace hemi::viewer
