#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "matrix/exchange_product.hpp"
#include "solver/row_product.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hemi {

/// Sources of one or more problems that are solved side by side. Arrays of N·columns hold column c of patch i
/// at [i·columns + c].
struct NetworkSources {
    std::uint32_t columns = 1;
    std::vector<double> emissivity;  ///< eps, N·columns, in [0, 1]; 0: what leaves is source + irradiation
    std::vector<double> source;      ///< s, W/m², N·columns, of any sign
    std::vector<double> environment; ///< J_env, W/m², columns
    std::vector<double> direct{};    ///< D, irradiation beside that, W/m², N·columns; empty: none
};

/// What comes of them, W/m², N·columns.
struct NetworkFluxes {
    std::vector<double> radiosity;   ///< J
    std::vector<double> irradiation; ///< G; equal to J where a patch sees nothing
    std::uint32_t iterations = 0;
    double residual = 0.0; ///< worst column's ||s - (J - (1 - eps) G)||_2 over that of the sources
};

/// Radiative exchange J = s + (1 - eps) G in the form of a network of the exchange areas x_ij = A_i F(i, j),
/// A_i (J_i - G_i) = sum_j x_ij (J_i - J_j) + A_i (e_i (J_i - J_env) - D_i): what leaves and does not arrive
/// comes back, so that every pair and every row balances exactly, patches that see nothing have J = G, and
/// emissivities of 0 are allowed. Solved by conjugate gradients with a diagonal preconditioner, in what the
/// radiosities differ from a common value. Source: A. K. Oppenheim, "Radiation analysis by the network
/// method", Trans. ASME 78, 1956. Of rows with clusters, x_ij is as in ExchangeProduct, times d_i d_j by
/// which its sums are again those of A_i F(i, j), as nearly as there are such d: what a patch gets of a
/// cluster's share depends on its place in it, which the transpose does not know. Source: P. A. Knight, D.
/// Ruiz, B. Ucar, "A symmetry preserving algorithm for matrix scaling", SIAM J. Matrix Anal. Appl. 35, 2014.
class ExchangeNetwork {
public:
    /// Called after every iteration with their number and the residual; false cancels.
    using Watcher = std::function<bool(std::uint32_t, double)>;

    /// @param factors      N rows, all known, and reciprocal or with clusters; must outlive this
    /// @param areas        N areas; must outlive this
    /// @param environment  e of every row
    /// @param isolated     1 for patches that exchange nothing, whatever the rows say
    ExchangeNetwork(const FormFactorMatrix& factors, std::span<const double> areas,
                    std::vector<double> environment, std::vector<std::uint8_t> isolated);

    [[nodiscard]] std::uint32_t size() const { return factors_.size(); }
    /// What a patch exchanges with others and the environment, a share of its area.
    [[nodiscard]] double exchanging(std::uint32_t i) const {
        return (sums_[i] / areas_[i]) + environment_[i];
    }
    [[nodiscard]] std::span<const double> environment() const { return environment_; }
    /// How far the sums of x_ij over j were from those of A_i F(i, j) before they were scaled, a share of
    /// these, rms by area: 0 but for rows with clusters.
    [[nodiscard]] double asymmetry() const { return asymmetry_; }
    /// Of every patch the smallest patch that it is connected with.
    [[nodiscard]] std::vector<std::uint32_t> enclosures() const;

    /// @throws NotConverged if the tolerance is not met; Cancelled
    [[nodiscard]] NetworkFluxes solve(const NetworkSources& sources, double tolerance,
                                      const Watcher& watcher = {}) const;

private:
    void find_scale(std::span<const double> connected);

    const FormFactorMatrix& factors_;
    std::span<const double> areas_;
    std::vector<double> environment_;
    std::vector<std::uint8_t> isolated_;
    std::vector<double> scale_; // d, of rows with clusters
    std::vector<double> sums_;  // of x_ij over all other patches j
    double asymmetry_ = 0.0;
};

} // namespace hemi
