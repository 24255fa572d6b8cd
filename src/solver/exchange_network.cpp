#include "solver/exchange_network.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/matrix/source_clusters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace hemi {

namespace {

/// sqrt(sum / reference), 0 where both are 0.
double relative(double sum, double reference) {
    return sum == 0.0 ? 0.0 : std::sqrt(sum / reference);
}

/// Conjugate gradients for u = J - common on the patches with eps < 1:
///   (A eps / rho + L) u = A (s - eps common) / rho + A (e (J_env - common) + D),  rho = 1 - eps,
/// L u = sum_j x_ij (u_i - u_j) + A_i e_i u_i; the others have u = s - common.
class NetworkSolver {
public:
    NetworkSolver(const FormFactorMatrix& factors, std::span<const double> areas,
                  std::span<const double> environment, std::span<const std::uint8_t> isolated,
                  std::span<const double> scale, std::span<const double> sums, const NetworkSources& sources)
        : areas_(areas), environment_(environment), isolated_(isolated), sums_(sums), sources_(sources),
          columns_(sources.columns), exchange_(factors, areas, ChannelField::padded(columns_), scale),
          zeros_(factors.size(), 0.0), u_(factors.size(), columns_), residual_(factors.size(), columns_),
          direction_(factors.size(), columns_), product_(factors.size(), columns_),
          connected_(factors.size(), columns_), common_(columns_, 0.0), source_squares_(columns_, 0.0),
          rounding_squares_(columns_, 0.0) {
        choose_common();
        begin();
    }

    /// Solves, or comes as near as rounding allows.
    NetworkFluxes solve(double tolerance, const ExchangeNetwork::Watcher& watcher) {
        NetworkFluxes fluxes;
        fluxes.residual = renew_residual();
        // Two orders below: what depends on the solution is to be right to about the tolerance.
        const double goal = 0.1 * tolerance;
        while (fluxes.residual > goal) {
            const double before = fluxes.residual;
            iterate(0.5 * goal, fluxes.iterations, watcher);
            fluxes.residual = renew_residual();
            if (fluxes.residual > 0.5 * before || fluxes.iterations >= most_iterations) {
                break;
            }
        }
        if (!(fluxes.residual <= tolerance)) {
            throw NotConverged(fmt::format("heat exchange: residual {:.3g} after {} iterations, above the "
                                           "tolerance {:.3g}; rounding keeps it there, or an enclosure is "
                                           "hardly connected with any temperature",
                                           fluxes.residual, fluxes.iterations, tolerance));
        }
        collect(fluxes);
        return fluxes;
    }

private:
    static constexpr std::uint32_t most_iterations = 20000;

    [[nodiscard]] double eps(std::uint32_t i, std::uint32_t c) const {
        return sources_.emissivity[std::size_t{i} * columns_ + c];
    }
    [[nodiscard]] double source(std::uint32_t i, std::uint32_t c) const {
        return sources_.source[std::size_t{i} * columns_ + c];
    }
    /// What comes from beyond the patches, over the common radiosity.
    [[nodiscard]] double beyond(std::uint32_t i, std::uint32_t c) const {
        const bool direct = !sources_.direct.empty() && isolated_[i] == 0;
        return environment_[i] * (sources_.environment[c] - common_[c]) +
               (direct ? sources_.direct[std::size_t{i} * columns_ + c] : 0.0);
    }
    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(areas_.size()); }
    /// A share of the area that is 0 where nothing holds the radiosity.
    [[nodiscard]] double diagonal(std::uint32_t i, std::uint32_t c) const {
        const double e = eps(i, c);
        return areas_[i] * (e / (1.0 - e) + environment_[i]) + sums_[i];
    }
    [[nodiscard]] bool is_free(std::uint32_t i, std::uint32_t c) const {
        return eps(i, c) < 1.0 && diagonal(i, c) > 0.0;
    }

    template <class Visit>
    void for_all(const Visit& visit) const {
        for (std::uint32_t i = 0; i < size(); ++i) {
            for (std::uint32_t c = 0; c < columns_; ++c) {
                visit(i, c);
            }
        }
    }

    /// The mean black body's radiosity.
    void choose_common() {
        std::vector<double> weights(columns_, 0.0);
        for_all([&](std::uint32_t i, std::uint32_t c) {
            if (eps(i, c) > 0.0) {
                common_[c] += areas_[i] * source(i, c);
                weights[c] += areas_[i] * eps(i, c);
            }
        });
        for (std::uint32_t c = 0; c < columns_; ++c) {
            common_[c] = weights[c] > 0.0 ? common_[c] / weights[c] : sources_.environment[c];
        }
    }

    void begin() {
        for_all([&](std::uint32_t i, std::uint32_t c) {
            const double e = eps(i, c);
            double driven = source(i, c) - e * common_[c];
            if (e == 1.0) {
                u_.patch(i)[c] = driven;
            }
            driven += (1.0 - e) * beyond(i, c);
            source_squares_[c] += driven * driven;
            const double all = std::abs(source(i, c)) + std::abs(common_[c]);
            rounding_squares_[c] += all * all;
        });
        for (std::uint32_t c = 0; c < columns_; ++c) {
            // Sources that are equal to the last bits have no differences to be solved for.
            constexpr double rounding = 1e-15;
            source_squares_[c] = std::max(source_squares_[c], rounding * rounding * rounding_squares_[c]);
        }
    }

    /// y = L z, which is 0 where all of z are equal and nothing is lost.
    void apply(const ChannelField& z, ChannelField& y) {
        for_all([&](std::uint32_t i, std::uint32_t c) {
            connected_.patch(i)[c] = isolated_[i] != 0 ? 0.0 : z.patch(i)[c];
        });
        exchange_.apply(zeros_, connected_.values(), y.values(), true);
        for_all([&](std::uint32_t i, std::uint32_t c) {
            y.patch(i)[c] = isolated_[i] != 0
                                ? 0.0
                                : (sums_[i] + areas_[i] * environment_[i]) * z.patch(i)[c] - y.patch(i)[c];
        });
    }

    double renew_residual() {
        apply(u_, product_);
        for_all([&](std::uint32_t i, std::uint32_t c) {
            double& r = residual_.patch(i)[c];
            if (!is_free(i, c)) {
                r = 0.0;
                return;
            }
            const double e = eps(i, c);
            r = areas_[i] *
                    ((source(i, c) - e * common_[c] - e * u_.patch(i)[c]) / (1.0 - e) + beyond(i, c)) -
                product_.patch(i)[c];
        });
        return worst();
    }

    /// Of the worst column, in units of J = s + rho G.
    [[nodiscard]] double worst() const {
        std::vector<double> squares(columns_, 0.0);
        for_all([&](std::uint32_t i, std::uint32_t c) {
            const double gap = (1.0 - eps(i, c)) * residual_.patch(i)[c] / areas_[i];
            squares[c] += gap * gap;
        });
        double worst = 0.0;
        for (std::uint32_t c = 0; c < columns_; ++c) {
            const double of_column = relative(squares[c], source_squares_[c]);
            if (!(of_column <= worst)) { // std::max would drop NaN
                worst = of_column;
            }
        }
        return worst;
    }

    void iterate(double goal, std::uint32_t& iterations, const ExchangeNetwork::Watcher& watcher) {
        std::vector<double> before(columns_, 0.0);
        double residual = 0.0;
        bool first = true;
        do {
            std::vector<double> squares(columns_, 0.0);
            for_all([&](std::uint32_t i, std::uint32_t c) {
                if (is_free(i, c)) {
                    squares[c] += residual_.patch(i)[c] * residual_.patch(i)[c] / diagonal(i, c);
                }
            });
            for_all([&](std::uint32_t i, std::uint32_t c) {
                double& p = direction_.patch(i)[c];
                const double beta = first || before[c] == 0.0 ? 0.0 : squares[c] / before[c];
                p = is_free(i, c) ? residual_.patch(i)[c] / diagonal(i, c) + beta * p : 0.0;
            });
            before = squares;
            first = false;
            apply(direction_, product_);
            std::vector<double> curvature(columns_, 0.0);
            for_all([&](std::uint32_t i, std::uint32_t c) {
                if (is_free(i, c)) {
                    const double e = eps(i, c);
                    double& y = product_.patch(i)[c];
                    y += areas_[i] * e / (1.0 - e) * direction_.patch(i)[c];
                    curvature[c] += y * direction_.patch(i)[c];
                }
            });
            for_all([&](std::uint32_t i, std::uint32_t c) {
                if (is_free(i, c) && curvature[c] > 0.0) {
                    const double alpha = squares[c] / curvature[c];
                    u_.patch(i)[c] += alpha * direction_.patch(i)[c];
                    residual_.patch(i)[c] -= alpha * product_.patch(i)[c];
                }
            });
            residual = worst();
            ++iterations;
            if (watcher && !watcher(iterations, residual)) {
                throw Cancelled();
            }
        } while (residual > goal && iterations < most_iterations);
    }

    void collect(NetworkFluxes& fluxes) {
        apply(u_, product_);
        fluxes.radiosity.reserve(std::size_t{size()} * columns_);
        fluxes.irradiation.reserve(std::size_t{size()} * columns_);
        for_all([&](std::uint32_t i, std::uint32_t c) {
            const double radiosity = common_[c] + u_.patch(i)[c];
            const double net = product_.patch(i)[c] / areas_[i] - beyond(i, c);
            fluxes.radiosity.push_back(radiosity);
            fluxes.irradiation.push_back(radiosity - net);
        });
    }

    std::span<const double> areas_;
    std::span<const double> environment_;
    std::span<const std::uint8_t> isolated_;
    std::span<const double> sums_;
    const NetworkSources& sources_;
    std::uint32_t columns_;
    ExchangeProduct exchange_;
    std::vector<double> zeros_;
    ChannelField u_;
    ChannelField residual_;
    ChannelField direction_;
    ChannelField product_;
    ChannelField connected_; // what a product is taken of
    std::vector<double> common_;
    std::vector<double> source_squares_;
    std::vector<double> rounding_squares_;
};

} // namespace

ExchangeNetwork::ExchangeNetwork(const FormFactorMatrix& factors, std::span<const double> areas,
                                 std::vector<double> environment, std::vector<std::uint8_t> isolated)
    : factors_(factors), areas_(areas), environment_(std::move(environment)), isolated_(std::move(isolated)),
      sums_(factors.size(), 0.0) {
    const std::vector<double> zeros(factors.size(), 0.0);
    std::vector<double> connected(factors.size(), 1.0);
    for (std::uint32_t i = 0; i < size(); ++i) {
        connected[i] = isolated_[i] != 0 ? 0.0 : 1.0;
    }
    if (factors.clusters() != nullptr) {
        find_scale(connected);
    }
    ExchangeProduct(factors, areas, 1, scale_).apply(zeros, connected, sums_, true);
    for (std::uint32_t i = 0; i < size(); ++i) {
        sums_[i] *= connected[i];
        environment_[i] *= connected[i];
    }
}

/// Scales what goes through clusters until x_ij sums to what the rows say, and finds how far it was from
/// that.
void ExchangeNetwork::find_scale(std::span<const double> connected) {
    constexpr int most_steps = 30; // each halves the gap, where it can be closed
    constexpr double enough = 1e-6;
    constexpr double nothing = 1e-6; // of an area: rounding of what is near
    const std::vector<double> zeros(size(), 0.0);
    std::vector<double> own(size());
    multiply(factors_, connected, 1, own);
    std::vector<double> near(size());
    ExchangeProduct(factors_, areas_, 1, zeros).apply(zeros, connected, near, true);
    scale_.assign(connected.begin(), connected.end());
    std::vector<double> sums(size());
    ExchangeProduct product(factors_, areas_, 1, scale_);
    for (int step = 0; step < most_steps; ++step) {
        product.apply(zeros, connected, sums, true);
        double squares = 0.0;
        double area = 0.0;
        for (std::uint32_t i = 0; i < size(); ++i) {
            if (connected[i] == 0.0 || !(own[i] > 0.0)) {
                continue;
            }
            const double wanted = areas_[i] * own[i];
            const double gap = sums[i] / wanted - 1.0;
            squares += areas_[i] * gap * gap;
            area += areas_[i];
            if (std::min(wanted, sums[i]) - near[i] > nothing * areas_[i]) {
                scale_[i] *= std::sqrt((wanted - near[i]) / (sums[i] - near[i]));
            }
        }
        const double gap = relative(squares, area);
        asymmetry_ = step == 0 ? gap : asymmetry_;
        if (gap <= enough) {
            break;
        }
    }
}

std::vector<std::uint32_t> ExchangeNetwork::enclosures() const {
    std::vector<std::uint32_t> parent(factors_.columns());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&parent](std::uint32_t i) {
        while (parent[i] != i) {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        return i;
    };
    const auto connect = [&](std::uint32_t i, std::uint32_t j) {
        const std::uint32_t a = root(i);
        const std::uint32_t b = root(j);
        parent[std::max(a, b)] = std::min(a, b);
    };
    std::vector<std::uint8_t> seen(factors_.columns() - size(), 0); // clusters
    for (std::uint32_t i = 0; i < size(); ++i) {
        const RowView row = factors_.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            const std::uint32_t j = row.columns[k];
            if (row.values[k] > 0.0f && isolated_[i] == 0 && (j >= size() || isolated_[j] == 0)) {
                connect(i, j);
                if (j >= size()) {
                    seen[j - size()] = 1;
                }
            }
        }
    }
    // What sees a cluster exchanges with all of its patches, through the clusters that make it up.
    for (std::uint32_t k = 0; k < seen.size(); ++k) {
        const SourceClusters::Node& node = factors_.clusters()->nodes()[k];
        if (seen[k] == 0) {
            continue;
        }
        if (node.child == 0) {
            const std::uint32_t patch = factors_.clusters()->order()[node.begin];
            if (isolated_[patch] == 0) {
                connect(size() + k, patch);
            }
            continue;
        }
        const double share = factors_.clusters()->first_share(k);
        for (const auto& [child, part] :
             {std::pair(node.child, share), std::pair(node.child + 1, 1.0 - share)}) {
            if (part > 0.0) {
                connect(size() + k, size() + child);
                seen[child] = 1;
            }
        }
    }
    for (std::uint32_t i = 0; i < size(); ++i) {
        parent[i] = root(i);
    }
    parent.resize(size());
    return parent;
}

NetworkFluxes ExchangeNetwork::solve(const NetworkSources& sources, double tolerance,
                                     const Watcher& watcher) const {
    return NetworkSolver(factors_, areas_, environment_, isolated_, scale_, sums_, sources)
        .solve(tolerance, watcher);
}

} // namespace hemi
