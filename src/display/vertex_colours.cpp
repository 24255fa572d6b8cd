#include "hemi/display/vertex_colours.hpp"

#include "display/smooth_surfaces.hpp"
#include "display/vertex_colours_detail.hpp"

#include "hemi/core/error.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace hemi {

namespace {

/// One pass over the corners of a mesh, in three steps that a reader can follow one by one.
class CornerValues {
public:
    CornerValues(const PatchMesh& mesh, const SmoothSurfaces& surfaces, std::uint32_t channels,
                 std::span<const double> values, std::span<const double> blocked, const GivenCorners& given)
        : mesh_(mesh), surfaces_(surfaces), channels_(channels), values_(values), blocked_(blocked),
          given_(given), result_(std::size_t{mesh.size()} * 4 * channels, 0.0F),
          known_(std::size_t{mesh.size()} * 4, 0) {}

    std::vector<float> compute() {
        std::vector<double> sum(channels_);
        std::vector<std::uint32_t> frontier;
        for (std::uint32_t patch = 0; patch < mesh_.size(); ++patch) {
            const auto ring = surfaces_.corners(patch);
            std::size_t known = 0;
            for (std::uint32_t k = 0; k < ring.size(); ++k) {
                known += first_value(patch, k, sum) ? 1U : 0U;
            }
            if (known > 0 && known < ring.size()) {
                frontier.push_back(patch);
            }
        }
        flood(std::move(frontier));
        // A surface that is covered altogether has nothing to take values from: it keeps its own.
        for (std::uint32_t patch = 0; patch < mesh_.size(); ++patch) {
            for (std::uint32_t k = 0; k < surfaces_.corners(patch).size(); ++k) {
                if (known_[slot(patch, k)] == 0) {
                    mean_at(patch, k, true, sum);
                }
            }
        }
        interpolate_hanging();
        return std::move(result_);
    }

private:
    /// Gives vertices on edges of larger patches what those show there.
    void interpolate_hanging() {
        for (const SmoothSurfaces::Hanging& hanging : surfaces_.hanging()) {
            const auto larger = surfaces_.corners(hanging.patch);
            const auto corner_at = [&](std::uint32_t vertex) {
                return static_cast<std::uint32_t>(std::find(larger.begin(), larger.end(), vertex) -
                                                  larger.begin());
            };
            const std::size_t from = slot(hanging.patch, corner_at(hanging.from));
            const std::size_t to = slot(hanging.patch, corner_at(hanging.to));
            for (const std::uint32_t patch : surfaces_.patches_at(hanging.vertex)) {
                const auto ring = surfaces_.corners(patch);
                for (std::uint32_t k = 0;
                     k < ring.size() && surfaces_.continues_at(hanging.vertex, hanging.patch, patch); ++k) {
                    if (ring[k] != hanging.vertex) {
                        continue;
                    }
                    for (std::uint32_t c = 0; c < channels_; ++c) {
                        const float a = result_[from * channels_ + c];
                        const float b = result_[to * channels_ + c];
                        result_[slot(patch, k) * channels_ + c] =
                            a + static_cast<float>(hanging.share) * (b - a);
                    }
                }
            }
        }
    }

    [[nodiscard]] static std::size_t slot(std::uint32_t patch, std::uint32_t k) {
        return std::size_t{patch} * 4 + k;
    }

    /// The value that a corner has of itself; false if there is none.
    bool first_value(std::uint32_t patch, std::uint32_t k, std::vector<double>& sum) {
        using Kind = GivenCorners::Kind;
        const std::size_t at = slot(patch, k);
        const Kind kind = given_.kinds.empty() ? Kind::mean : given_.kinds[at];
        if (kind == Kind::given) {
            std::copy_n(given_.values.begin() + static_cast<std::ptrdiff_t>(at * channels_), channels_,
                        result_.begin() + static_cast<std::ptrdiff_t>(at * channels_));
            known_[at] = 1;
        }
        return kind == Kind::given || (kind == Kind::mean && mean_at(patch, k, false, sum));
    }

    /// Area-weighted mean over the patches that continue `patch` at its corner `k`; false if there is none.
    bool mean_at(std::uint32_t patch, std::uint32_t k, bool with_covered, std::vector<double>& sum) {
        std::fill(sum.begin(), sum.end(), 0.0);
        double weight = 0.0;
        const std::uint32_t vertex = surfaces_.corners(patch)[k];
        for (const std::uint32_t other : surfaces_.patches_at(vertex)) {
            if ((!with_covered && is_covered(blocked_, other)) ||
                !surfaces_.continues_at(vertex, patch, other)) {
                continue;
            }
            const double area = mesh_.areas()[other];
            weight += area;
            for (std::uint32_t c = 0; c < channels_; ++c) {
                sum[c] += area * values_[std::size_t{other} * channels_ + c];
            }
        }
        if (!(weight > 0.0)) {
            return false;
        }
        for (std::uint32_t c = 0; c < channels_; ++c) {
            result_[slot(patch, k) * channels_ + c] = static_cast<float>(sum[c] / weight);
        }
        known_[slot(patch, k)] = 1;
        return true;
    }

    /// Carries values outwards from patches that have some corners known and some not, ring by ring: an
    /// unknown corner takes the mean over the touching patches' known corners.
    void flood(std::vector<std::uint32_t> frontier) {
        std::vector<double> sums(known_.size() * channels_, 0.0);
        std::vector<std::uint32_t> counts(known_.size(), 0);
        std::vector<std::size_t> touched;
        std::vector<double> mean(channels_);
        while (!frontier.empty()) {
            touched.clear();
            for (const std::uint32_t patch : frontier) {
                known_mean(patch, mean);
                const auto ring = surfaces_.corners(patch);
                for (std::uint32_t k = 0; k < ring.size(); ++k) {
                    if (known_[slot(patch, k)] == 0) {
                        give(patch, ring[k], mean, sums, counts, touched);
                    }
                }
            }
            frontier.clear();
            for (const std::size_t place : touched) {
                for (std::uint32_t c = 0; c < channels_; ++c) {
                    result_[place * channels_ + c] =
                        static_cast<float>(sums[place * channels_ + c] / counts[place]);
                }
                known_[place] = 1;
                frontier.push_back(static_cast<std::uint32_t>(place / 4));
            }
            std::sort(frontier.begin(), frontier.end());
            frontier.erase(std::unique(frontier.begin(), frontier.end()), frontier.end());
        }
    }

    /// Adds `mean` to the unknown corners at `vertex` of all patches that continue `patch`.
    void give(std::uint32_t patch, std::uint32_t vertex, const std::vector<double>& mean,
              std::vector<double>& sums, std::vector<std::uint32_t>& counts,
              std::vector<std::size_t>& touched) const {
        for (const std::uint32_t other : surfaces_.patches_at(vertex)) {
            if (!surfaces_.continues_at(vertex, patch, other)) {
                continue;
            }
            const auto ring = surfaces_.corners(other);
            for (std::uint32_t k = 0; k < ring.size(); ++k) {
                const std::size_t place = slot(other, k);
                if (ring[k] != vertex || known_[place] != 0) {
                    continue;
                }
                if (counts[place]++ == 0) {
                    touched.push_back(place);
                }
                for (std::uint32_t c = 0; c < channels_; ++c) {
                    sums[place * channels_ + c] += mean[c];
                }
            }
        }
    }

    void known_mean(std::uint32_t patch, std::vector<double>& mean) const {
        std::fill(mean.begin(), mean.end(), 0.0);
        std::uint32_t count = 0;
        for (std::uint32_t k = 0; k < surfaces_.corners(patch).size(); ++k) {
            if (known_[slot(patch, k)] == 0) {
                continue;
            }
            ++count;
            for (std::uint32_t c = 0; c < channels_; ++c) {
                mean[c] += static_cast<double>(result_[slot(patch, k) * channels_ + c]);
            }
        }
        for (double& value : mean) {
            value /= count;
        }
    }

    const PatchMesh& mesh_;
    const SmoothSurfaces& surfaces_;
    std::uint32_t channels_;
    std::span<const double> values_;
    std::span<const double> blocked_;
    const GivenCorners& given_;
    std::vector<float> result_;
    std::vector<std::uint8_t> known_; ///< whether a corner has its value
};

} // namespace

std::vector<float> corner_values(const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                                 std::uint32_t channels, std::span<const double> values,
                                 std::span<const double> blocked, const GivenCorners& given) {
    if (channels == 0 || values.size() != std::size_t{mesh.size()} * channels) {
        throw InvalidArgument(fmt::format("corner_values: {} values for {} patches of {} channels",
                                          values.size(), mesh.size(), channels));
    }
    if (!blocked.empty() && blocked.size() != mesh.size()) {
        throw InvalidArgument(fmt::format("corner_values: {} blocked shares for {} patches; none or one each",
                                          blocked.size(), mesh.size()));
    }
    return CornerValues(mesh, surfaces, channels, values, blocked, given).compute();
}

std::vector<float> corner_values(const PatchMesh& mesh, std::uint32_t channels,
                                 std::span<const double> values, std::span<const double> blocked) {
    return corner_values(mesh, SmoothSurfaces(mesh), channels, values, blocked);
}

} // namespace hemi
