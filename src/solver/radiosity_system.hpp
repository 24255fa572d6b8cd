#pragma once

#include "hemi/solver/solver.hpp"
#include "solver/row_balance.hpp"
#include "solver/row_product.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hemi {

/// (I - rho F) B = E' = E + rho (e B_env + D) in the layout of the solvers. Every channel's sources are
/// scaled by a power of two to about 1, which changes no bit and keeps squares of sources of any magnitude
/// finite.
class RadiositySystem {
public:
    explicit RadiositySystem(const RadiosityProblem& problem);

    [[nodiscard]] const FormFactorMatrix& factors() const { return factors_; }
    [[nodiscard]] std::uint32_t size() const { return factors_.size(); }
    [[nodiscard]] std::uint32_t channels() const { return channels_; }
    [[nodiscard]] const ChannelField& reflectance() const { return reflectance_; }
    [[nodiscard]] const ChannelField& source() const { return source_; }
    /// F(i, i) with the row's defect.
    [[nodiscard]] double self(std::uint32_t i) const { return self_[i]; }
    /// The defect alone.
    [[nodiscard]] double defect(std::uint32_t i) const { return defect_[i]; }
    [[nodiscard]] double dominance() const { return dominance_; }

    /// sqrt(squares) / ||E'|| of a channel, 0 of a dark one.
    [[nodiscard]] double relative(double squares, std::uint32_t c) const;
    /// The worst channel of sqrt(squares) / ||E'||; NaN if one is. Dark channels do not count.
    [[nodiscard]] double worst_relative(const std::vector<double>& squares) const;
    /// The other way round; dark channels are dark.
    [[nodiscard]] ChannelField scaled(std::span<const double> values) const;
    /// A field in the caller's units and layout.
    [[nodiscard]] std::vector<double> unscaled(const ChannelField& field) const;

private:
    void add_row(const RadiosityProblem& problem, std::uint32_t i);
    void scale_channel(std::uint32_t c);

    const FormFactorMatrix& factors_;
    std::uint32_t channels_;
    ChannelField reflectance_;
    ChannelField source_;
    std::vector<double> self_;
    std::vector<double> defect_;
    std::vector<int> exponent_;
    std::vector<double> source_norm_;
    double dominance_ = 0.0;
};

/// What every method needs to stop and to say why it failed.
struct SolverRun {
    const SolverSettings& settings;
    Solution& solution;

    /// Counts a sweep, shows `radiosity()` to who watches, and calls back.
    /// @throws Cancelled; NotConverged if the residual is not finite
    void count(double residual, const std::function<std::vector<double>()>& radiosity) const;
    [[noreturn]] void fail(const std::string& reason) const;
};

/// Gauss–Seidel or Jacobi sweeps until the tolerance is met.
[[nodiscard]] ChannelField solve_by_sweeps(const RadiositySystem& system, const SolverRun& run);

/// Conjugate gradients until the tolerance is met. The rows must be reciprocal.
[[nodiscard]] ChannelField solve_by_conjugate_gradients(const RadiositySystem& system,
                                                        std::span<const double> areas, const SolverRun& run);

} // namespace hemi
