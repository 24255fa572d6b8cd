#include "engine/visibility_weighted/factor_assembly.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

namespace {

/// With Enclosure::automatic a scene is closed if no row sees more of the environment than this. A little
/// above the weight of the heaviest texel of 4 hemicubes of 64² texels (4 / (pi 64²) / 4 = 8e-5): a single
/// one may slip through where the edges of two walls meet.
constexpr double max_leak = 1e-4;

bool is_open(std::span<const double> environment, Enclosure enclosure) {
    return std::any_of(environment.begin(), environment.end(),
                       [enclosure](double share) { return sees_environment(share, enclosure); });
}

std::uint64_t count_seen(std::span<const PairVisibility> pairs) {
    std::uint32_t count = 0;
    for (const PairVisibility pair : pairs) {
        count += pair.is_hidden() ? 0u : 1u;
    }
    return count;
}

/// Blocks with room for every pair that is not hidden.
std::vector<RowBlock> empty_blocks(const PairTable& pairs, const FormFactorMatrix& matrix) {
    std::vector<RowBlock> blocks(matrix.blocks().begin(), matrix.blocks().end());
    parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            RowBlock& block = blocks[b];
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                const std::uint32_t k = pairs.index.row_of(block.first_row + local);
                block.begin[local + 1] = block.begin[local];
                if (k != RowIndex::no_row) {
                    block.known[local] = 1;
                    block.environment[local] = pairs.environment[k];
                    block.blocked[local] = pairs.blocked[k];
                    block.begin[local + 1] += count_seen(pairs.visibility[k]);
                }
            }
            block.columns.resize(block.begin.back());
            block.values.resize(block.begin.back());
            block.visibility.resize(block.begin.back());
        }
    });
    return blocks;
}

void put(RowBlock& block, std::uint64_t at, std::uint32_t column, double value, std::uint8_t visibility) {
    block.columns[at] = column;
    block.values[at] = static_cast<float>(value);
    block.visibility[at] = visibility;
}

/// Fills rows pair by pair, so that each F0 is found once.
class PairFiller {
public:
    /// All must outlive this.
    PairFiller(const PairTable& pairs, const PatchMesh& mesh, const ExchangeAreas& exchange_areas,
               std::vector<RowBlock>& blocks)
        : pairs_(pairs), areas_(mesh.areas()), exchange_areas_(exchange_areas), blocks_(blocks),
          next_(mesh.size()) {
        for (const RowBlock& block : blocks) {
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                next_[block.first_row + local] = block.begin[local];
            }
        }
    }

    /// Pairs of i with the patches j > i in [from, upto): entry (i, j), and entry (j, i), whose columns come
    /// in ascending order if rows i do. Different ranges of j touch different entries.
    void fill(std::uint32_t i, std::uint32_t from, std::uint32_t upto) {
        from = std::max(from, i + 1);
        if (from >= upto) {
            return;
        }
        const std::uint32_t k = pairs_.index.row_of(i);
        if (k == RowIndex::no_row) { // only the rows that were asked for have this column
            const auto patches = pairs_.index.patches();
            for (auto other = std::lower_bound(patches.begin(), patches.end(), from);
                 other != patches.end() && *other < upto; ++other) {
                const PairVisibility pair = pairs_.visibility[pairs_.index.row_of(*other)][i];
                if (!pair.is_hidden()) {
                    put_below(i, *other, exchange_areas_(i, *other) * pair.value(), pair.stored());
                }
            }
            return;
        }
        RowBlock& block = blocks_[i / FormFactorMatrix::block_rows];
        std::uint64_t at =
            block.begin[i - block.first_row] + count_seen(std::span(pairs_.visibility[k]).first(from));
        for (std::uint32_t j = from; j < upto; ++j) {
            const PairVisibility pair = pairs_.visibility[k][j];
            if (pair.is_hidden()) {
                continue;
            }
            const double exchange_area = exchange_areas_(i, j) * pair.value();
            put(block, at++, j, exchange_area / areas_[i], pair.stored());
            if (pairs_.index.row_of(j) != RowIndex::no_row) {
                put_below(i, j, exchange_area, pair.stored());
            }
        }
    }

private:
    /// Entry (j, i), below the diagonal.
    void put_below(std::uint32_t i, std::uint32_t j, double exchange_area, std::uint8_t visibility) {
        put(blocks_[j / FormFactorMatrix::block_rows], next_[j]++, i, exchange_area / areas_[j], visibility);
    }

    const PairTable& pairs_;
    std::span<const double> areas_;
    const ExchangeAreas& exchange_areas_;
    std::vector<RowBlock>& blocks_;
    std::vector<std::uint64_t> next_; ///< where the next entry of a row goes below the diagonal, in its block
};

/// Drops entries that are zero after all, and sets the environment share of an open scene's rows to what is
/// left of 1: F0 knows that better than hemicubes do.
void finish(RowBlock& block, bool open) {
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

/// What a patch and all images of another exchange.
struct FoldedEntry {
    std::uint32_t column;
    std::uint8_t visibility;
    double exchange; ///< A_i F(i, j)
};

/// Sums over the images of patches.
class Folder {
public:
    /// All must outlive this.
    Folder(const PairTable& pairs, const ImageMesh& images, const ExchangeAreas& exchange_areas)
        : pairs_(pairs), images_(images), exchange_areas_(exchange_areas) {}

    /// Row k, but for the columns below its patch's whose rows hold the pair.
    [[nodiscard]] std::vector<FoldedEntry> operator()(std::uint32_t k) const {
        const std::uint32_t i = pairs_.index.patches()[k];
        std::vector<FoldedEntry> entries;
        for (std::uint32_t j = 0; j < images_.size(); ++j) {
            if (j < i && pairs_.index.row_of(j) != RowIndex::no_row) {
                continue;
            }
            if (const FoldedEntry entry = add_up(k, i, j); entry.exchange > 0.0) {
                entries.push_back(entry);
            }
        }
        return entries;
    }

private:
    [[nodiscard]] FoldedEntry add_up(std::uint32_t k, std::uint32_t i, std::uint32_t j) const {
        const std::vector<PairVisibility>& row = pairs_.visibility[k];
        bool seen = false;
        for (std::uint32_t image = 0; image < images_.images() && !seen; ++image) {
            seen = !row[images_.patch(image, j)].is_hidden();
        }
        double exchange = 0.0;
        double unoccluded = 0.0; // with what is hidden: V of all is the share of it
        bool clear = true;
        for (std::uint32_t image = 0; image < images_.images() && seen; ++image) {
            const std::uint32_t patch = images_.patch(image, j);
            if (const double area = patch == i ? 0.0 : exchange_areas_(i, patch); area > 0.0) {
                unoccluded += area;
                exchange += area * row[patch].value();
                clear = clear && row[patch].stored() == visibility_clear;
            }
        }
        if (!(exchange > 0.0)) {
            return {j, 0, 0.0};
        }
        const PairVisibility all =
            clear ? PairVisibility::clear() : PairVisibility::from(exchange / unoccluded);
        return {j, all.stored(), exchange};
    }

    const PairTable& pairs_;
    const ImageMesh& images_;
    const ExchangeAreas& exchange_areas_;
};

/// Factors of pairs of which each is in one of two rows.
FormFactorMatrix assemble_folded(const PairTable& pairs, const ImageMesh& images, ExchangeRule rule,
                                 bool open, const Progress& progress) {
    const ExchangeAreas exchange_areas(images.mesh(), rule);
    const Folder fold(pairs, images, exchange_areas);
    const std::span<const std::uint32_t> patches = pairs.index.patches();
    const std::span<const double> areas = images.mesh().areas();
    std::vector<std::vector<FoldedEntry>> rows(patches.size()); // those on and above the diagonal
    std::vector<std::vector<FoldedEntry>> below(patches.size());
    for (std::uint32_t first = 0; first < patches.size(); first += FormFactorMatrix::block_rows) {
        const auto end = static_cast<std::uint32_t>(
            std::min<std::size_t>(first + FormFactorMatrix::block_rows, patches.size()));
        parallel_for(end - first, 1, [&](std::size_t from, std::size_t upto) {
            for (std::size_t k = first + from; k < first + upto; ++k) {
                rows[k] = fold(static_cast<std::uint32_t>(k));
            }
        });
        for (std::uint32_t k = first; k < end; ++k) {
            for (const FoldedEntry& entry : rows[k]) {
                const std::uint32_t other = pairs.index.row_of(entry.column);
                if (entry.column > patches[k] && other != RowIndex::no_row) {
                    below[other].push_back({patches[k], entry.visibility, entry.exchange});
                }
            }
        }
        if (progress && !progress(end, patches.size())) {
            throw Cancelled();
        }
    }
    FormFactorMatrix matrix(images.size());
    for (const RowBlock& empty : std::vector<RowBlock>(matrix.blocks().begin(), matrix.blocks().end())) {
        RowBlock block = empty;
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            const std::uint32_t i = block.first_row + local;
            const std::uint32_t k = pairs.index.row_of(i);
            block.begin[local + 1] = block.begin[local];
            if (k == RowIndex::no_row) {
                continue;
            }
            block.known[local] = 1;
            block.environment[local] = pairs.environment[k];
            block.blocked[local] = pairs.blocked[k];
            std::vector<FoldedEntry> all;
            std::merge(rows[k].begin(), rows[k].end(), below[k].begin(), below[k].end(),
                       std::back_inserter(all),
                       [](const FoldedEntry& a, const FoldedEntry& b) { return a.column < b.column; });
            for (const FoldedEntry& entry : all) {
                block.columns.push_back(entry.column);
                block.values.push_back(static_cast<float>(entry.exchange / areas[i]));
                block.visibility.push_back(entry.visibility);
            }
            block.begin[local + 1] = block.columns.size();
            std::vector<FoldedEntry>().swap(rows[k]);
            std::vector<FoldedEntry>().swap(below[k]);
        }
        finish(block, open);
        matrix.set_block(std::move(block));
    }
    return matrix;
}

} // namespace

bool sees_environment(double share, Enclosure enclosure) {
    return enclosure == Enclosure::open || (enclosure == Enclosure::automatic && share > max_leak);
}

FormFactorMatrix assemble_factors(const PairTable& pairs, const ImageMesh& images, ExchangeRule rule,
                                  Enclosure enclosure, const Progress& progress) {
    if (images.any()) {
        return assemble_folded(pairs, images, rule, is_open(pairs.environment, enclosure), progress);
    }
    const PatchMesh& mesh = images.mesh();
    const std::uint32_t size = mesh.size();
    const ExchangeAreas exchange_areas(mesh, rule);
    const bool open = is_open(pairs.environment, enclosure);
    FormFactorMatrix matrix(size);
    std::vector<RowBlock> blocks = empty_blocks(pairs, matrix);
    PairFiller filler(pairs, mesh, exchange_areas, blocks);
    constexpr std::size_t columns_at_once = 256;
    for (RowBlock& block : blocks) {
        const std::uint32_t first = block.first_row;
        const std::uint32_t end = first + block.rows();
        // A thread owns its columns: it fills their part of this block's rows above the diagonal, and
        // this block's columns of the rows that they stand for, below the diagonal.
        parallel_for(size - first, columns_at_once, [&](std::size_t from, std::size_t upto) {
            for (std::uint32_t i = first; i < end; ++i) {
                filler.fill(i, first + static_cast<std::uint32_t>(from),
                            first + static_cast<std::uint32_t>(upto));
            }
        });
        finish(block, open);
        matrix.set_block(std::move(block));
        if (progress && !progress(end, size)) {
            throw Cancelled();
        }
    }
    return matrix;
}

} // namespace hemi
