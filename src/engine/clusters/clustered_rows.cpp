#include "hemi/engine/clustered_rows.hpp"

#include "core/freed_memory.hpp"
#include "core/parallel_for.hpp"
#include "engine/clusters/cluster_tree.hpp"
#include "engine/clusters/row_maker.hpp"
#include "engine/environment_verdict.hpp"
#include "engine/row_sample.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/core/row_memory.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/matrix/repair.hpp"
#include "scene/enclosed_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace hemi {

namespace {

void append(RowBlock& block, const ClusterEntry& entry) {
    block.columns.push_back(entry.column);
    block.values.push_back(entry.value);
    block.visibility.push_back(entry.visibility);
}

void append(RowBlock& block, const EntryList& entries) {
    for (std::uint32_t k = 0; k < entries.size(); ++k) {
        append(block, entries[k]);
    }
}

void append(RowBlock& block, const PackedEntries& entries) {
    entries.visit([&block](std::uint32_t column, float value, std::uint8_t visibility) {
        append(block, {column, value, visibility});
    });
}

void reserve(RowBlock& block, std::size_t entries) {
    block.columns.reserve(entries);
    block.values.reserve(entries);
    block.visibility.reserve(entries);
}

/// Those of the patches whose rows this rank computes: whole blocks, in turn.
std::vector<std::uint32_t> share_of(std::span<const std::uint32_t> patches) {
    std::vector<std::uint32_t> own;
    for (const std::uint32_t patch : patches) {
        if (patch / FormFactorMatrix::block_rows % ranks().size() == ranks().rank()) {
            own.push_back(patch);
        }
    }
    return own;
}

/// Rows of visibility in, rows of factors out, many at a time in threads. Blocks of them are kept when all
/// their rows are there.
class RowCollector {
public:
    /// All must outlive this.
    /// @param patches  whose rows this rank makes, ascending
    /// @param keeper   may be null
    RowCollector(const PatchMesh& mesh, const ClusterTree& tree, const ClusterSettings& settings,
                 std::span<const std::uint32_t> patches, ClusteredRowKeeper* keeper)
        : mesh_(mesh), tree_(tree), exchange_(mesh, settings.rule), opening_(settings.opening),
          max_memory_(settings.max_memory), patches_(patches), keeper_(keeper), rows_(mesh.size()),
          there_(mesh.size(), 0), missing_(mesh.size() / FormFactorMatrix::block_rows + 1, 0) {
        for (const std::uint32_t patch : patches) {
            ++missing_[patch / FormFactorMatrix::block_rows];
        }
    }

    /// Takes the rows that were kept before.
    /// @param each  called after every one
    /// @return patches whose rows are still missing
    template <class Each>
    [[nodiscard]] std::vector<std::uint32_t> resume(const Each& each) {
        if (keeper_ == nullptr) {
            return {patches_.begin(), patches_.end()};
        }
        keeper_->resume(tree_.clusters(), patches_, [&](std::uint32_t patch, const RowView& row, bool hides) {
            add(patch, row, hides);
            each();
        });
        std::vector<std::uint32_t> missing;
        std::copy_if(patches_.begin(), patches_.end(), std::back_inserter(missing),
                     [this](std::uint32_t patch) { return there_[patch] == 0; });
        return missing;
    }

    void take(std::uint32_t patch, const VisibilityRow& row) {
        if (row.sets != nullptr && !places_) {
            places_.emplace(*row.sets, tree_, mesh_);
        }
        kept_.push_back({patch,
                         {row.columns.begin(), row.columns.end()},
                         {row.shares.begin(), row.shares.end()},
                         {row.texels.begin(), row.texels.end()},
                         {row.joint.begin(), row.joint.end()},
                         row.environment,
                         row.blocked});
        if (kept_.size() == rows_at_once) {
            flush();
        }
    }

    /// The rows of all patches, of which those that did not come are empty.
    [[nodiscard]] std::vector<ClusteredRow> finish() {
        flush();
        if (ranks().size() > 1) {
            exchange();
        }
        return std::move(rows_);
    }

private:
    static constexpr std::size_t rows_at_once = 256;

    void flush() {
        std::atomic<std::uint64_t> bytes = 0;
        constexpr std::size_t grain = 32;
        parallel_for(kept_.size(), grain, [&](std::size_t begin, std::size_t end) {
            const auto maker = take_maker();
            for (std::size_t k = begin; k < end; ++k) {
                ClusteredRow row = maker->make(kept_[k], places_ ? &*places_ : nullptr);
                bytes += row.bytes();
                rows_[kept_[k].patch] = std::move(row);
            }
            give_back(maker);
        });
        for (const SeenRow& kept : kept_) {
            made_.push_back(kept.patch);
            if (--missing_[kept.patch / FormFactorMatrix::block_rows] == 0 && keeper_ != nullptr) {
                keep_block(kept.patch - kept.patch % FormFactorMatrix::block_rows);
            }
        }
        kept_.clear();
        bytes_ += bytes;
        check_memory();
    }

    /// Adds a row that was kept before.
    void add(std::uint32_t patch, const RowView& row, bool hides) {
        const auto far = std::lower_bound(row.columns.begin(), row.columns.end(), mesh_.size());
        const auto near = static_cast<std::size_t>(far - row.columns.begin());
        std::vector<ClusterEntry> entries;
        for (std::size_t k = 0; k < near; ++k) {
            entries.push_back({row.columns[k], row.values[k], row.visibility[k]});
        }
        rows_[patch] = {EntryList(entries),
                        {row.columns.subspan(near), row.values.subspan(near), row.visibility.subspan(near)},
                        row.environment,
                        row.blocked,
                        hides};
        there_[patch] = 1;
        made_.push_back(patch);
        --missing_[patch / FormFactorMatrix::block_rows];
        bytes_ += rows_[patch].bytes();
        check_memory();
    }

    /// Keeps the rows of a block that were not kept before.
    void keep_block(std::uint32_t first) {
        const std::uint32_t count = std::min(FormFactorMatrix::block_rows, mesh_.size() - first);
        RowBlock block;
        block.first_row = first;
        block.begin.assign(1, 0);
        block.known.assign(count, 0);
        std::vector<std::uint8_t> hides(count, 0);
        const auto wanted = std::lower_bound(patches_.begin(), patches_.end(), first);
        for (auto patch = wanted; patch != patches_.end() && *patch < first + count; ++patch) {
            block.known[*patch - first] = there_[*patch] == 0 ? 1 : 0;
        }
        const ClusteredRow none;
        const auto row_of = [&](std::uint32_t local) -> const ClusteredRow& {
            return block.known[local] != 0 ? rows_[first + local] : none;
        };
        std::size_t entries = 0;
        for (std::uint32_t local = 0; local < count; ++local) {
            entries += row_of(local).near.size() + row_of(local).far.size();
        }
        reserve(block, entries);
        for (std::uint32_t local = 0; local < count; ++local) {
            const ClusteredRow& row = row_of(local);
            append(block, row.near);
            append(block, row.far);
            block.begin.push_back(block.columns.size());
            block.environment.push_back(row.environment);
            block.blocked.push_back(row.blocked);
            hides[local] = row.hides ? 1 : 0;
        }
        keeper_->keep(block, hides);
    }

    void check_memory() const {
        if (bytes_ > max_memory_ && !rows_are_in_file()) {
            throw OutOfMemory(fmt::format("rows of clusters need more than {}. Larger patches, a larger "
                                          "cluster error or a higher limit would help",
                                          memory_text(max_memory_)),
                              {"cluster-error", "patch-size", "max-memory", "scratch"});
        }
    }

    /// Gives all ranks the rows that each has made.
    void exchange() {
        struct Head {
            std::uint64_t patch;
            std::uint64_t near;
            std::uint64_t far;
            double environment;
            double blocked;
            std::uint64_t hides;
        };
        const std::uint64_t own = made_.size();
        const std::vector<std::uint64_t> counts = gather_values(ranks(), std::span(&own, 1));
        const std::uint64_t most = *std::max_element(counts.begin(), counts.end());
        bytes_ = 0;
        for (std::uint64_t first = 0; first < most; first += rows_at_once) {
            std::vector<Head> heads;
            std::vector<ClusterEntry> entries;
            for (std::uint64_t k = first; k < std::min<std::uint64_t>(own, first + rows_at_once); ++k) {
                const ClusteredRow& row = rows_[made_[k]];
                heads.push_back({made_[k], row.near.size(), row.far.size(), row.environment, row.blocked,
                                 row.hides ? 1u : 0u});
                for (std::uint32_t e = 0; e < row.near.size(); ++e) {
                    entries.push_back(row.near[e]);
                }
                row.far.visit([&](std::uint32_t column, float value, std::uint8_t visibility) {
                    entries.push_back({column, value, visibility});
                });
            }
            heads = gather_values(ranks(), std::span<const Head>(heads));
            entries = gather_values(ranks(), std::span<const ClusterEntry>(entries));
            auto next = entries.begin();
            EntryArrays of_clusters;
            for (const Head& head : heads) {
                const auto far = next + static_cast<std::ptrdiff_t>(head.near);
                const auto end = far + static_cast<std::ptrdiff_t>(head.far);
                of_clusters.clear();
                std::for_each(far, end, [&](const ClusterEntry& entry) { of_clusters.add(entry); });
                rows_[head.patch] = {EntryList({next, far}), of_clusters.packed(), head.environment,
                                     head.blocked, head.hides != 0};
                bytes_ += rows_[head.patch].bytes();
                next = end;
            }
            check_memory();
        }
    }

    [[nodiscard]] std::shared_ptr<RowMaker> take_maker() {
        const std::lock_guard lock(mutex_);
        if (makers_.empty()) {
            return std::make_shared<RowMaker>(mesh_, tree_, exchange_, opening_);
        }
        auto maker = std::move(makers_.back());
        makers_.pop_back();
        return maker;
    }
    void give_back(std::shared_ptr<RowMaker> maker) {
        const std::lock_guard lock(mutex_);
        makers_.push_back(std::move(maker));
    }

    const PatchMesh& mesh_;
    const ClusterTree& tree_;
    ExchangeAreas exchange_;
    double opening_;
    std::optional<SetPlaces> places_; ///< where rows tell of sets
    std::uint64_t max_memory_;
    std::span<const std::uint32_t> patches_;
    ClusteredRowKeeper* keeper_;
    std::uint64_t bytes_ = 0;
    std::vector<SeenRow> kept_;
    std::vector<std::uint32_t> made_; ///< patches whose rows this rank has
    std::vector<ClusteredRow> rows_;
    std::vector<std::uint8_t> there_;    ///< of patches: whether the keeper gave their rows
    std::vector<std::uint32_t> missing_; ///< of blocks: rows that are wanted and not there
    std::mutex mutex_;
    std::vector<std::shared_ptr<RowMaker>> makers_; ///< idle
};

/// Pairs near each other, as one matrix. Takes them out of the rows.
FormFactorMatrix near_pairs(std::vector<ClusteredRow>& rows, std::span<const std::uint32_t> patches,
                            const PatchMesh& mesh) {
    FormFactorMatrix matrix(mesh.size());
    std::vector<RowBlock> blocks = matrix.take_blocks();
    for (const std::uint32_t i : patches) {
        blocks[i / FormFactorMatrix::block_rows].known[i % FormFactorMatrix::block_rows] = 1;
    }
    parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            RowBlock& block = blocks[b];
            std::size_t entries = 0;
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                entries += rows[block.first_row + local].near.size();
            }
            reserve(block, entries);
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                append(block, std::exchange(rows[block.first_row + local].near, {}));
                block.begin[local + 1] = block.columns.size();
            }
            matrix.set_block(std::move(block));
        }
    });
    return matrix;
}

/// Balances rows: what they miss of their sums, or have too much, is shared out by the variances of the
/// factors. Far ones get their shares at once, near ones theirs as pairs.
class RowBalancer {
public:
    /// @param near  reciprocal pairs of the rows
    /// @param open  whether the scene is
    RowBalancer(std::vector<ClusteredRow>& rows, FormFactorMatrix& near, const PatchMesh& mesh,
                ExchangeRule rule, bool open)
        : rows_(rows), near_(near), mesh_(mesh), open_(open) {
        settings_.unoccluded_error = unoccluded_error(rule);
    }

    void run() {
        // A row of the pairs alone lacks what is far: it counts as environment meanwhile.
        std::vector<RowBlock> blocks = near_.take_blocks();
        for (RowBlock& block : blocks) {
            const std::uint32_t first = block.first_row;
            near_.set_block(std::move(block));
            for (std::uint32_t i = first; i < std::min(first + FormFactorMatrix::block_rows, near_.size());
                 ++i) {
                if (near_.known(i)) {
                    balance_far(rows_[i], near_.row(i), true);
                }
            }
        }
        blocks = near_.take_blocks();
        for (RowBlock& block : blocks) {
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                const ClusteredRow& row = rows_[block.first_row + local];
                block.environment[local] = block.known[local] != 0 ? row.environment + row.far.sum() : 0.0;
                block.blocked[local] = block.known[local] != 0 ? row.blocked : 0.0;
            }
            near_.set_block(std::move(block));
        }
        (void)repair(near_, mesh_.areas(), Repair::closure, settings_);
        // Few pairs, held at their bounds, cannot always take their share: far factors take what is left.
        for (std::uint32_t i = 0; i < near_.size(); ++i) {
            if (near_.known(i)) {
                balance_far(rows_[i], near_.row(i), false);
            }
        }
    }

private:
    /// Of a factor F0 V: that of a share of samples that are hidden or not, and of F0.
    [[nodiscard]] double variance(double value, std::uint8_t code) const {
        const double visibility = std::max<double>(code, 0.5) / visibility_clear;
        const double sampling = code == visibility_clear ? 0.0 : visibility * (1.0 - visibility);
        const double rule = settings_.unoccluded_error * settings_.unoccluded_error;
        return value * value * (sampling + rule) / (visibility * visibility);
    }

    /// @param shared  whether the near pairs take their share of what is missing, or are as they stay
    void balance_far(ClusteredRow& row, const RowView& near, bool shared) {
        const double most = std::max(0.0, 1.0 - row.blocked);
        const double sum = near.sum() + row.far.sum();
        if (open_ && row.environment > 0.0) {
            row.environment = std::max(0.0, most - sum);
        }
        const double missing = most - row.environment - sum;
        double variances = 0.0;
        for (std::size_t k = 0; k < near.columns.size() && shared; ++k) {
            variances += variance(static_cast<double>(near.values[k]), near.visibility[k]);
        }
        row.far.visit([&](std::uint32_t, float value, std::uint8_t visibility) {
            variances += variance(static_cast<double>(value), visibility);
        });
        row.far.change_values([&](float old, std::uint8_t visibility) {
            const auto value = static_cast<double>(old);
            return static_cast<float>(
                std::max(0.0, value + missing * variance(value, visibility) / variances));
        });
    }

    std::vector<ClusteredRow>& rows_;
    FormFactorMatrix& near_;
    const PatchMesh& mesh_;
    RepairSettings settings_;
    bool open_;
};

/// What rows know of the environment.
class Evidence {
public:
    /// All must outlive this.
    Evidence(const std::vector<ClusteredRow>& rows, const FormFactorMatrix& near, const PatchMesh& mesh,
             const SourceClusters& clusters, ExchangeRule rule, Enclosure enclosure)
        : rows_(rows), near_(near), mesh_(mesh), clusters_(clusters), rule_(rule) {
        if (enclosure == Enclosure::automatic) {
            space_.emplace(mesh);
        }
    }

    [[nodiscard]] EnvironmentEvidence of_row(std::uint32_t i) const {
        const ClusteredRow& row = rows_[i];
        if (space_ && space_->encloses(i)) {
            return {.texels = row.environment, .enclosed = true};
        }
        return of_row(i, rule_, [](const ClusterEntry& entry) { return entry.value; });
    }

    /// The same with factors by the exact rule.
    [[nodiscard]] EnvironmentEvidence exactly(std::uint32_t i) const {
        const ExchangeAreas exact(mesh_, ExchangeRule::exact);
        return of_row(i, ExchangeRule::exact, [&](const ClusterEntry& entry) {
            double exchange = 0.0;
            if (entry.column < mesh_.size()) {
                exchange = exact(i, entry.column);
            } else {
                for (const std::uint32_t j : clusters_.patches(entry.column - mesh_.size())) {
                    exchange += j != i ? exact(i, j) : 0.0;
                }
            }
            const double visibility = static_cast<double>(entry.visibility) / visibility_clear;
            return static_cast<float>(exchange * visibility / mesh_.areas()[i]);
        });
    }

private:
    template <class Value>
    [[nodiscard]] EnvironmentEvidence of_row(std::uint32_t i, ExchangeRule rule, const Value& value) const {
        std::vector<std::uint32_t> columns;
        std::vector<float> values;
        std::vector<std::uint8_t> visibility;
        const auto add = [&](const ClusterEntry& entry) {
            columns.push_back(entry.column);
            values.push_back(value(entry));
            visibility.push_back(entry.visibility);
        };
        const RowView near = near_.row(i);
        for (std::size_t k = 0; k < near.columns.size(); ++k) {
            add({near.columns[k], near.values[k], near.visibility[k]});
        }
        const ClusteredRow& row = rows_[i];
        row.far.visit([&](std::uint32_t column, float of_cluster, std::uint8_t seen) {
            add({column, of_cluster, seen});
        });
        return evidence_of({columns, values, visibility, row.environment, row.blocked}, row.hides, rule);
    }

    const std::vector<ClusteredRow>& rows_;
    const FormFactorMatrix& near_;
    const PatchMesh& mesh_;
    const SourceClusters& clusters_;
    ExchangeRule rule_;
    std::optional<EnclosedSpace> space_;
};

/// Sets the environment's share of all rows, which texels measured, to what the scene and the factors say.
/// @return whether the scene is open
bool settle_environment(std::vector<ClusteredRow>& rows, const Evidence& evidence,
                        std::span<const std::uint32_t> patches, Enclosure enclosure) {
    if (enclosure == Enclosure::closed) {
        return false;
    }
    std::vector<EnvironmentEvidence> known(patches.size());
    parallel_for(patches.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            known[k] = evidence.of_row(patches[k]);
        }
    });
    const bool open = is_open(known, enclosure, [&](std::size_t k) { return evidence.exactly(patches[k]); });
    for (std::size_t k = 0; k < patches.size(); ++k) {
        rows[patches[k]].environment = environment_share(known[k], enclosure, open);
    }
    return open;
}

/// Factor by which the near factors of a row are changed where nothing else balances it: no far ones are
/// there, or not enough. The row's pairs are then reciprocal only as far as visibility is known.
double last_change(const ClusteredRow& row, double near_sum) {
    const double far_sum = row.far.sum();
    const double rounding = 1e-6 + 2e-6 * far_sum; // of floats, and of what is packed
    const double sum = near_sum + far_sum;
    const double missing = 1.0 - row.environment - row.blocked - sum;
    if (!(near_sum > 0.0) || std::abs(missing) < rounding || row.blocked > buried_above) {
        return 1.0;
    }
    return std::max(0.0, 1.0 + missing / near_sum);
}

/// Near pairs of rows as they are in the end.
void finish_near(RowBlock& pairs, const std::vector<ClusteredRow>& rows) {
    for (std::uint32_t local = 0; local < pairs.rows(); ++local) {
        const ClusteredRow& row = rows[pairs.first_row + local];
        const double change = last_change(row, pairs.row(local).sum());
        for (std::uint64_t k = pairs.begin[local]; k < pairs.begin[local + 1]; ++k) {
            pairs.values[k] = static_cast<float>(change * static_cast<double>(pairs.values[k]));
        }
        pairs.environment[local] = row.environment;
        pairs.blocked[local] = row.blocked;
    }
}

/// Takes the entries of clusters out of the rows of a block.
std::vector<PackedEntries> take_far(const RowBlock& pairs, std::vector<ClusteredRow>& rows) {
    std::vector<PackedEntries> far;
    for (std::uint32_t local = 0; local < pairs.rows(); ++local) {
        far.push_back(std::exchange(rows[pairs.first_row + local], {}).far);
    }
    return far;
}

/// Areas as far as they exchange light with others: what reaches backs counts for nobody. All of a patch
/// without a row.
std::vector<double> seen_areas(const std::vector<ClusteredRow>& rows, const PatchMesh& mesh) {
    std::vector<double> areas(mesh.areas().begin(), mesh.areas().end());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        areas[i] *= std::max(0.0, 1.0 - rows[i].blocked);
    }
    return areas;
}

} // namespace

double cluster_opening(double error) {
    // Fitted to the figures of the declaration.
    constexpr double error_of_opening_one = 0.023;
    return std::sqrt(error / error_of_opening_one);
}

FormFactorMatrix compute_clustered(VisibilityProvider& visibility, const PatchMesh& mesh,
                                   std::span<const std::uint32_t> patches, const ClusterSettings& settings,
                                   Enclosure enclosure, const Progress& progress,
                                   ClusteredRowKeeper* keeper) {
    if (!(settings.opening > 0.0) || !std::isfinite(settings.opening)) {
        throw InvalidArgument(
            fmt::format("opening of clusters {}; it must be finite and above 0", settings.opening));
    }
    if (!settings.apart.empty() && settings.apart.size() != mesh.size()) {
        throw InvalidArgument(fmt::format("clusters: {} patches are said to stand apart or not, of {}",
                                          settings.apart.size(), mesh.size()));
    }
    const ClusterTree tree(mesh, settings.apart);
    std::vector<ClusteredRow> rows;
    {
        const std::vector<std::uint32_t> own = share_of(patches);
        RowCollector collector(mesh, tree, settings, own, keeper);
        std::size_t done = 0;
        const auto count = [&] {
            if (progress && !progress(++done, own.size())) {
                throw Cancelled();
            }
        };
        const std::vector<std::uint32_t> missing = collector.resume(count);
        if (!missing.empty()) {
            visibility.rows(missing, [&](std::uint32_t patch, const VisibilityRow& row) {
                collector.take(patch, row);
                count();
            });
        }
        rows = collector.finish();
    }
    FormFactorMatrix near = near_pairs(rows, patches, mesh);
    give_freed_memory_back();
    (void)repair(near, mesh.areas(), Repair::reciprocity);
    const Evidence evidence(rows, near, mesh, *tree.clusters(), settings.rule, enclosure);
    const bool open = settle_environment(rows, evidence, patches, enclosure);
    RowBalancer(rows, near, mesh, settings.rule, open).run();
    FormFactorMatrix matrix(
        mesh.size(), std::make_shared<SourceClusters>(tree.clusters()->with_weights(seen_areas(rows, mesh))));
    std::vector<RowBlock> pairs = near.take_blocks();
    parallel_for(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            finish_near(pairs[b], rows);
            std::vector<PackedEntries> far = take_far(pairs[b], rows);
            matrix.set_block(std::move(pairs[b]), std::move(far));
        }
    });
    give_freed_memory_back();
    return matrix;
}

std::uint64_t clustered_memory(const FormFactorMatrix& sample, std::size_t sampled, std::size_t rows) {
    const auto empty = static_cast<double>(FormFactorMatrix(sample.size(), sample.clusters()).memory_bytes());
    const double entries = rows_are_in_file() ? 0.0 : static_cast<double>(sample.memory_bytes()) - empty;
    return static_cast<std::uint64_t>(
        memory_margin * (empty + entries * static_cast<double>(rows) / static_cast<double>(sampled)));
}

} // namespace hemi
