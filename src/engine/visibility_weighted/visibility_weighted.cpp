#include "hemi/engine/visibility_weighted.hpp"

#include "core/parallel_for.hpp"
#include "engine/rays/shadow_rays.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

namespace hemi {

namespace {

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();
/// A row that sees less of the environment than this, measured, is not thought to be meant to.
constexpr double leak_limit = 1e-4;

/// What one patch's hemicubes say of another patch, in two bytes: the visible share in 4095ths, and how many
/// texels that rests on as a power of two.
class Sighting {
public:
    Sighting() = default;
    Sighting(float share, std::uint8_t evidence) {
        const std::uint32_t parts = static_cast<std::uint32_t>(std::lround(4095.0f * share));
        const std::uint32_t strength =
            evidence == visibility_clear
                ? clear
                : std::min<std::uint32_t>(static_cast<std::uint32_t>(std::bit_width(evidence)), clear - 1);
        bits_ = static_cast<std::uint16_t>(parts | strength << 12);
    }
    [[nodiscard]] bool known() const { return bits_ >> 12 != 0; }
    [[nodiscard]] bool is_clear() const { return bits_ >> 12 == clear; }
    [[nodiscard]] double share() const { return (bits_ & 0xFFF) / 4095.0; }
    /// In texels. A clear pair counts as one that many texels saw: how many is not kept.
    [[nodiscard]] double weight() const {
        return is_clear() ? 32.0 : static_cast<double>(1u << (bits_ >> 12)) * 0.5;
    }

private:
    static constexpr std::uint32_t clear = 15;
    std::uint16_t bits_ = 0;
};

/// V of a pair: 0 if nothing is seen, all ones if nothing was hidden, else in 65,534ths.
using PairCode = std::uint16_t;
constexpr PairCode pair_hidden = 0;
constexpr PairCode pair_clear = 0xFFFF;

PairCode pair_code(double visibility) {
    // Less than half a unit is kept as one: the pair was seen.
    return visibility <= 0.0 ? pair_hidden
                             : static_cast<PairCode>(std::clamp(visibility * 65534.0 + 0.5, 1.0, 65534.0));
}
double visibility_of(PairCode code) {
    return code == pair_clear ? 1.0 : code / 65534.0;
}
std::uint8_t stored_visibility(PairCode code) {
    return code == pair_clear
               ? visibility_clear
               : static_cast<std::uint8_t>(
                     std::clamp(visibility_of(code) * visibility_clear + 0.5, 1.0, visibility_clear - 1.0));
}

/// V of a pair from what both ends saw, and on how many texels it rests.
struct Combined {
    PairCode code;
    double texels;
};

Combined combine(Sighting a, Sighting b, double assumed) {
    if (!a.known() && !b.known()) {
        return {pair_code(assumed), 0.0};
    }
    const double weight_a = a.known() ? a.weight() : 0.0;
    const double weight_b = b.known() ? b.weight() : 0.0;
    const double texels = weight_a + weight_b;
    if ((a.is_clear() || !a.known()) && (b.is_clear() || !b.known())) {
        return {pair_clear, texels};
    }
    return {pair_code((weight_a * a.share() + weight_b * b.share()) / texels), texels};
}

/// Tells quickly which patches have parts in front of each other.
class Facing {
public:
    explicit Facing(const PatchMesh& mesh) : patches_(mesh.size()), tolerance_(mesh.rounding()) {
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const PatchCorners corners = mesh.corners(i);
            Patch& patch = patches_[i];
            patch.normal = mesh.normal(i);
            patch.centre = mesh.centres()[i];
            patch.height = glm::dot(patch.normal, patch.centre);
            for (std::size_t k = 0; k < 4; ++k) {
                patch.corners[k] = corners.points[std::min<std::size_t>(k, corners.count - 1)];
            }
        }
    }
    [[nodiscard]] bool operator()(std::uint32_t i, std::uint32_t j) const {
        return height(i, j) > tolerance_ && height(j, i) > tolerance_;
    }
    /// Of the highest corner of j above the plane of i.
    [[nodiscard]] double height(std::uint32_t i, std::uint32_t j) const {
        const Patch& plane = patches_[i];
        double highest = -std::numeric_limits<double>::infinity();
        for (const Vec3& corner : patches_[j].corners) {
            highest = std::max(highest, glm::dot(plane.normal, corner));
        }
        return highest - plane.height;
    }

private:
    struct Patch {
        Vec3 normal;
        Vec3 centre;
        double height;
        std::array<Vec3, 4> corners;
    };
    std::vector<Patch> patches_;
    double tolerance_;
};

/// For every patch the run of patches around it in the mesh's order that lie beside it and face alike: where
/// too few texels fall on it, theirs stand in. Patches of a subdivided surface were pooled already.
class Neighbours {
public:
    explicit Neighbours(const PatchMesh& mesh) : first_(mesh.size()), end_(mesh.size()) {
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const auto alike = [&](std::uint32_t j) {
                const double reach = 6.0 * std::sqrt(mesh.areas()[i]);
                return glm::dot(mesh.normal(i), mesh.normal(j)) > 0.8 &&
                       glm::distance(mesh.centres()[i], mesh.centres()[j]) < reach;
            };
            constexpr std::uint32_t most = 8;
            std::uint32_t first = i;
            while (first > 0 && i - first < most && alike(first - 1)) {
                --first;
            }
            std::uint32_t end = i + 1;
            while (end < mesh.size() && end - i <= most && alike(end)) {
                ++end;
            }
            first_[i] = first;
            end_[i] = end;
        }
    }
    /// What is known of the neighbours of j, nearest in the order first; nothing if nothing is.
    [[nodiscard]] Sighting stand_in(std::span<const Sighting> row, std::uint32_t j) const {
        const std::uint32_t reach = std::max(j - first_[j], end_[j] - 1 - j);
        for (std::uint32_t k = 1; k <= reach; ++k) {
            const Sighting before = j >= first_[j] + k ? row[j - k] : Sighting();
            const Sighting after = j + k < end_[j] ? row[j + k] : Sighting();
            if (before.known() || after.known()) {
                const double weight = (before.known() ? 1.0 : 0.0) + (after.known() ? 1.0 : 0.0);
                const double share =
                    ((before.known() ? before.share() : 0.0) + (after.known() ? after.share() : 0.0)) /
                    weight;
                return {static_cast<float>(share), 1};
            }
        }
        return {};
    }

private:
    std::vector<std::uint32_t> first_, end_;
};

class Hybrid {
public:
    Hybrid(const PatchMesh& mesh, std::span<const std::uint32_t> patches,
           const VisibilityWeightedSettings& settings)
        : mesh_(mesh), size_(mesh.size()), patches_(patches), areas_(mesh, settings.rule), facing_(mesh),
          shadow_rays_(settings.shadow_rays), row_of_(size_, nobody) {
        for (std::uint32_t k = 0; k < patches.size(); ++k) {
            row_of_[patches[k]] = k;
        }
        sightings_.resize(patches.size());
        environment_.resize(patches.size());
        blocked_.resize(patches.size());
    }

    void see(RowProvider& visibility, const Progress& progress) {
        std::size_t done = 0;
        visibility.rows(patches_, [&](std::uint32_t patch, const RowView& row) {
            const std::uint32_t k = row_of_[patch];
            if (k == nobody || !sightings_[k].empty()) {
                throw Error(fmt::format("row {} of the visibility came twice or unasked", patch));
            }
            std::vector<Sighting>& sightings = sightings_[k];
            sightings.resize(size_);
            for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
                sightings[row.columns[entry]] = {row.values[entry], row.visibility[entry]};
            }
            environment_[k] = row.environment;
            blocked_[k] = row.blocked;
            ++done;
            if (progress && !progress(done, patches_.size())) {
                throw Cancelled();
            }
        });
        if (done != patches_.size()) {
            throw Error(fmt::format("{} gave {} of {} rows of the visibility", visibility.renderer(), done,
                                    patches_.size()));
        }
    }

    /// One code for both directions of every pair; sightings become codes.
    void combine_pairs(const Progress& pairs_combined) {
        const Neighbours neighbours(mesh_);
        codes_.resize(patches_.size());
        mean_.resize(patches_.size());
        parallel_for(patches_.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                mean_[k] = mean_share(sightings_[k]);
                codes_[k].assign(size_, pair_hidden);
            }
        });
        std::optional<ShadowRays> rays;
        double least = 0.0;
        if (shadow_rays_ > 0) {
            rays.emplace(mesh_);
            least = least_variance(neighbours);
        }
        // A pair of two rows is combined by the lower one, which alone writes both entries.
        const auto combine_part = [&](std::size_t k, std::uint32_t from, std::uint32_t upto) {
            const std::uint32_t i = patches_[k];
            for (std::uint32_t j = from; j < upto; ++j) {
                const std::uint32_t other = row_of_[j];
                if (other != nobody && j <= i) {
                    continue;
                }
                Combined pair = combine_pair(neighbours, k, j);
                if (rays && wants_rays(pair) && variance(pair, i, j) >= least) {
                    sharpen(*rays, pair, i, j);
                }
                codes_[k][j] = pair.code;
                if (other != nobody) {
                    codes_[other][i] = pair.code;
                }
            }
        };
        // By tiles, few enough columns for the caches: what lies on the other side of the diagonal is far
        // apart from column to column, but side by side from row to row.
        constexpr std::size_t rows_at_once = 64;
        constexpr std::size_t columns_at_once = 64;
        for (std::size_t first = 0; first < patches_.size(); first += rows_at_once) {
            const std::size_t end = std::min(first + rows_at_once, patches_.size());
            parallel_for(size_, columns_at_once, [&](std::size_t from, std::size_t upto) {
                for (std::size_t k = first; k < end; ++k) {
                    combine_part(k, static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(upto));
                }
            });
            if (pairs_combined && !pairs_combined(end, patches_.size())) {
                throw Cancelled();
            }
        }
        sightings_.clear();
        sightings_.shrink_to_fit();
    }

    FormFactorMatrix factors(Enclosure enclosure, const Progress& progress) {
        FormFactorMatrix matrix(size_);
        std::vector<RowBlock> blocks = empty_blocks(matrix);
        std::vector<std::uint64_t> next(size_); // where the next entry of a row goes, in its block
        for (const RowBlock& block : blocks) {
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                next[block.first_row + local] = block.begin[local];
            }
        }
        const bool open = is_open(enclosure);
        constexpr std::size_t columns_at_once = 256;
        for (RowBlock& block : blocks) {
            const std::uint32_t first = block.first_row;
            const std::uint32_t end = first + block.rows();
            // A thread owns its columns: it fills their part of this block's rows above the diagonal, and
            // this block's columns of the rows that they stand for, below the diagonal.
            parallel_for(size_ - first, columns_at_once, [&](std::size_t from, std::size_t upto) {
                for (std::uint32_t i = first; i < end; ++i) {
                    fill(i, first + static_cast<std::uint32_t>(from),
                         first + static_cast<std::uint32_t>(upto), blocks, next);
                }
            });
            finish(block, open);
            matrix.set_block(std::move(block));
            if (progress && !progress(end, size_)) {
                throw Cancelled();
            }
        }
        return matrix;
    }

private:
    /// What both ends of row k and patch j know of each other.
    [[nodiscard]] Combined combine_pair(const Neighbours& neighbours, std::size_t k, std::uint32_t j) const {
        const std::uint32_t i = patches_[k];
        const std::uint32_t other = row_of_[j];
        const Sighting nothing;
        Sighting there = sightings_[k][j];
        Sighting back = other == nobody ? nothing : sightings_[other][i];
        const auto sees_none = [](Sighting one) { return one.known() && one.share() == 0.0; };
        if ((sees_none(there) && !back.known()) || (sees_none(back) && !there.known()) || !facing_(i, j)) {
            return {pair_hidden, 1.0};
        }
        double assumed = 1.0;
        if (!there.known() && !back.known()) {
            there = neighbours.stand_in(sightings_[k], j);
            back = other == nobody ? nothing : neighbours.stand_in(sightings_[other], i);
            assumed = other == nobody ? mean_[k] : 0.5 * (mean_[k] + mean_[other]);
        }
        return combine(there, back, assumed);
    }

    /// Whether a pair is partly hidden, and few texels say how much.
    [[nodiscard]] bool wants_rays(const Combined& pair) const {
        // Nearly clear or nearly hidden, and not just by a guess: a few rays know no better.
        constexpr double sure = 0.005;
        const double visibility = visibility_of(pair.code);
        const bool seen_sharply = visibility < sure || visibility > 1.0 - sure;
        return (pair.texels == 0.0 || !seen_sharply) && pair.texels < 4.0 * shadow_rays_;
    }

    /// About the variance of the larger of F(i, j) and F(j, i): (F0)² V (1 - V) over the number of texels.
    [[nodiscard]] double variance(const Combined& pair, std::uint32_t i, std::uint32_t j) const {
        const Vec3 way = mesh_.centres()[j] - mesh_.centres()[i];
        const double squared = glm::dot(way, way);
        // From centre to centre, or from what of either rises above the other's plane where that is more.
        const double here = std::max(glm::dot(way, mesh_.normal(i)), 0.5 * facing_.height(i, j));
        const double there = std::max(-glm::dot(way, mesh_.normal(j)), 0.5 * facing_.height(j, i));
        const double larger = std::max(mesh_.areas()[i], mesh_.areas()[j]);
        const double factor = std::min(1.0, here * there * larger / (squared * squared));
        // Half a texel and even odds where nothing is known.
        const double visibility = pair.texels == 0.0 ? 0.5 : visibility_of(pair.code);
        return factor * factor * visibility * (1.0 - visibility) / std::max(pair.texels, 0.5);
    }

    /// Rays pay where much is to be gained: pairs with less variance than this have together a twentieth of
    /// the variance of all that want rays, in a sample of rows.
    [[nodiscard]] double least_variance(const Neighbours& neighbours) const {
        constexpr double left = 0.05;
        constexpr std::size_t samples = 64;
        constexpr int lowest = -160; // powers of two
        std::array<double, 1 - lowest> sums{};
        const std::size_t rows = std::min(samples, patches_.size());
        for (std::size_t sample = 0; sample < rows; ++sample) {
            const std::size_t k = (2 * sample + 1) * patches_.size() / (2 * rows);
            for (std::uint32_t j = 0; j < size_; ++j) {
                const Combined pair = combine_pair(neighbours, k, j);
                if (const double one = wants_rays(pair) ? variance(pair, patches_[k], j) : 0.0; one > 0.0) {
                    sums[static_cast<std::size_t>(std::clamp(std::ilogb(one), lowest, 0) - lowest)] += one;
                }
            }
        }
        const double all = std::accumulate(sums.begin(), sums.end(), 0.0);
        if (!(all > 0.0)) {
            return 0.0; // the sample says nothing: rays for all that want them
        }
        double below = 0.0;
        int power = lowest;
        for (; power < 0 && below + sums[static_cast<std::size_t>(power - lowest)] <= left * all; ++power) {
            below += sums[static_cast<std::size_t>(power - lowest)];
        }
        return std::ldexp(1.0, power);
    }

    /// Weighs shadow rays in.
    void sharpen(const ShadowRays& rays, Combined& pair, std::uint32_t i, std::uint32_t j) const {
        const ShadowRays::Estimate traced = rays.visibility(i, j, shadow_rays_);
        if (const double all = pair.texels + traced.rays; all > 0.0) {
            pair.code =
                pair_code((pair.texels * visibility_of(pair.code) + traced.rays * traced.visibility) / all);
        }
    }

    static double mean_share(std::span<const Sighting> row) {
        double sum = 0.0;
        std::size_t known = 0;
        for (const Sighting sighting : row) {
            sum += sighting.known() ? sighting.share() : 0.0;
            known += sighting.known() ? 1 : 0;
        }
        return known == 0 ? 1.0 : sum / static_cast<double>(known);
    }

    [[nodiscard]] bool is_open(Enclosure enclosure) const {
        return enclosure == Enclosure::open || (enclosure == Enclosure::automatic &&
                                                std::any_of(environment_.begin(), environment_.end(),
                                                            [](double share) { return share > leak_limit; }));
    }

    /// Blocks with room for every pair that may be seen.
    [[nodiscard]] std::vector<RowBlock> empty_blocks(const FormFactorMatrix& matrix) const {
        std::vector<RowBlock> blocks(matrix.blocks().begin(), matrix.blocks().end());
        parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b) {
                RowBlock& block = blocks[b];
                for (std::uint32_t local = 0; local < block.rows(); ++local) {
                    const std::uint32_t k = row_of_[block.first_row + local];
                    block.begin[local + 1] = block.begin[local];
                    if (k != nobody) {
                        block.known[local] = 1;
                        block.environment[local] = environment_[k];
                        block.blocked[local] = blocked_[k];
                        block.begin[local + 1] += count_seen(codes_[k]);
                    }
                }
                block.columns.resize(block.begin.back());
                block.values.resize(block.begin.back());
                block.visibility.resize(block.begin.back());
            }
        });
        return blocks;
    }

    static std::uint64_t count_seen(std::span<const PairCode> codes) {
        std::uint32_t count = 0;
        for (const PairCode code : codes) {
            count += code != pair_hidden ? 1u : 0u;
        }
        return count;
    }

    /// Pairs of i with the patches j > i in [from, upto): entry (i, j), and entry (j, i), whose columns so
    /// come in ascending order.
    void fill(std::uint32_t i, std::uint32_t from, std::uint32_t upto, std::vector<RowBlock>& blocks,
              std::vector<std::uint64_t>& next) const {
        from = std::max(from, i + 1);
        if (from >= upto) {
            return;
        }
        const std::uint32_t k = row_of_[i];
        RowBlock& block = blocks[i / FormFactorMatrix::block_rows];
        std::uint64_t here = 0;
        if (k != nobody) {
            here = block.begin[i - block.first_row] + count_seen(std::span(codes_[k]).first(from));
        }
        if (k == nobody) { // only the rows that were asked for have this column
            for (auto other = std::lower_bound(patches_.begin(), patches_.end(), from);
                 other != patches_.end() && *other < upto; ++other) {
                put_below(i, *other, codes_[row_of_[*other]][i], blocks, next);
            }
            return;
        }
        for (std::uint32_t j = from; j < upto; ++j) {
            const PairCode code = codes_[k][j];
            if (code == pair_hidden) {
                continue;
            }
            const double area = areas_(i, j) * visibility_of(code);
            const std::uint8_t visibility = stored_visibility(code);
            put(block, here++, j, area / mesh_.areas()[i], visibility);
            if (row_of_[j] != nobody) {
                put(blocks[j / FormFactorMatrix::block_rows], next[j]++, i, area / mesh_.areas()[j],
                    visibility);
            }
        }
    }

    /// Entry (j, i), i < j, of a row j whose partner i has none.
    void put_below(std::uint32_t i, std::uint32_t j, PairCode code, std::vector<RowBlock>& blocks,
                   std::vector<std::uint64_t>& next) const {
        if (code != pair_hidden) {
            put(blocks[j / FormFactorMatrix::block_rows], next[j]++, i,
                areas_(i, j) * visibility_of(code) / mesh_.areas()[j], stored_visibility(code));
        }
    }

    static void put(RowBlock& block, std::uint64_t at, std::uint32_t column, double value,
                    std::uint8_t visibility) {
        block.columns[at] = column;
        block.values[at] = static_cast<float>(value);
        block.visibility[at] = visibility;
    }

    /// Drops entries that are zero after all and settles the balance.
    void finish(RowBlock& block, bool open) const {
        std::uint64_t kept = 0;
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            const std::uint64_t begin = block.begin[local];
            block.begin[local] = kept;
            double sum = 0.0;
            for (std::uint64_t entry = begin; entry < block.begin[local + 1]; ++entry) {
                if (block.values[entry] > 0.0f) {
                    block.columns[kept] = block.columns[entry];
                    block.values[kept] = block.values[entry];
                    block.visibility[kept] = block.visibility[entry];
                    sum += static_cast<double>(block.values[entry]);
                    ++kept;
                }
            }
            if (open && block.environment[local] > 0.0) {
                block.environment[local] = std::max(0.0, 1.0 - block.blocked[local] - sum);
            }
        }
        block.begin.back() = kept;
        block.columns.resize(kept);
        block.values.resize(kept);
        block.visibility.resize(kept);
        block.columns.shrink_to_fit();
        block.values.shrink_to_fit();
        block.visibility.shrink_to_fit();
    }

    const PatchMesh& mesh_;
    std::uint32_t size_;
    std::span<const std::uint32_t> patches_;
    ExchangeAreas areas_;
    Facing facing_;
    std::uint32_t shadow_rays_;         ///< a pair
    std::vector<std::uint32_t> row_of_; ///< patch -> position in patches_, or nobody
    std::vector<std::vector<Sighting>> sightings_;
    std::vector<std::vector<PairCode>> codes_;
    std::vector<double> mean_; ///< of the shares that a row knows
    std::vector<double> environment_, blocked_;
};

} // namespace

VisibilityWeightedEstimate estimate_visibility_weighted(RowProvider& visibility,
                                                        std::span<const std::uint32_t> patches,
                                                        std::uint32_t samples) {
    std::vector<std::uint32_t> sampled;
    const std::uint64_t count = std::min<std::uint64_t>(samples, patches.size());
    for (std::uint64_t k = 0; k < count; ++k) {
        sampled.push_back(patches[(2 * k + 1) * patches.size() / (2 * count)]);
    }
    VisibilityWeightedEstimate estimate;
    if (!sampled.empty()) {
        // The first row also pays for contexts and workers, which do not grow with the number of rows.
        visibility.rows(std::span(sampled).first(1), [](std::uint32_t, const RowView&) {});
        std::uint64_t entries = 0;
        const auto start = std::chrono::steady_clock::now();
        visibility.rows(sampled, [&](std::uint32_t, const RowView& row) {
            entries += static_cast<std::uint64_t>(
                std::count_if(row.values.begin(), row.values.end(), [](float v) { return v > 0.0f; }));
        });
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        const auto sampled_rows = static_cast<double>(sampled.size());
        estimate.entries_per_row = static_cast<double>(entries) / sampled_rows;
        estimate.seconds = elapsed.count() / sampled_rows * static_cast<double>(patches.size());
    }
    const auto rows = static_cast<double>(patches.size());
    const double matrix =
        estimate.entries_per_row * rows * (sizeof(std::uint32_t) + sizeof(float) + sizeof(std::uint8_t)) +
        static_cast<double>(FormFactorMatrix(visibility.size()).memory_bytes());
    const double table = rows * visibility.size() * (sizeof(Sighting) + sizeof(PairCode));
    estimate.memory_bytes = static_cast<std::uint64_t>(1.2 * matrix + table);
    return estimate;
}

FormFactorMatrix compute_visibility_weighted(RowProvider& visibility, const PatchMesh& mesh,
                                             std::span<const std::uint32_t> patches,
                                             const VisibilityWeightedSettings& settings, Enclosure enclosure,
                                             const Progress& rows_done, const Progress& pairs_combined,
                                             const Progress& pairs_done) {
    Hybrid hybrid(mesh, patches, settings);
    hybrid.see(visibility, rows_done);
    hybrid.combine_pairs(pairs_combined);
    return hybrid.factors(enclosure, pairs_done);
}

} // namespace hemi
