#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hemi {

/// Fixed-point iterations x = g(x) with Anderson's acceleration: the next x is the combination of those
/// before whose g(x) - x is least, which for linear g is what GMRES finds.
class Anderson {
public:
    /// @param window  how many iterations before are looked at
    explicit Anderson(std::size_t window) : window_(window) {}

    /// The next x.
    [[nodiscard]] std::vector<double> next(std::span<const double> x, std::span<const double> g);

private:
    std::size_t window_;
    std::vector<double> x_; // of the iteration before
    std::vector<double> f_; // g(x) - x of it
    std::vector<std::vector<double>> dx_;
    std::vector<std::vector<double>> df_;
};

} // namespace hemi
