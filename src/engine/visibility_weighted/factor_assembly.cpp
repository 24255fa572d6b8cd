#include "engine/visibility_weighted/factor_assembly.hpp"

#include "core/parallel_for.hpp"
#include "engine/environment_verdict.hpp"
#include "engine/visibility_weighted/divided_assembly.hpp"
#include "engine/visibility_weighted/facing_test.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "scene/enclosed_space.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

namespace {

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

/// Fills rows pair by pair, of a patch and all images of another, which are one entry.
class FoldedFiller {
public:
    /// Columns that a thread owns: it fills them in the rows that it goes through, and their rows below the
    /// diagonal.
    static constexpr std::uint32_t columns_at_once = 256;

    /// All must outlive this. Makes room in the blocks.
    FoldedFiller(const PairTable& pairs, const ImageMesh& images, const ExchangeAreas& exchange_areas,
                 std::vector<RowBlock>& blocks)
        : pairs_(pairs), images_(images), exchange_areas_(exchange_areas), blocks_(blocks),
          chunks_((images.size() + columns_at_once - 1) / columns_at_once),
          before_(pairs.index.rows() * (chunks_ + 1), 0), next_(images.size()) {
        parallel_for(pairs.index.rows(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                count(k);
            }
        });
        for (RowBlock& block : blocks) {
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                const std::uint32_t k = pairs.index.row_of(block.first_row + local);
                next_[block.first_row + local] = block.begin[local];
                block.begin[local + 1] = block.begin[local];
                if (k != RowIndex::no_row) {
                    block.known[local] = 1;
                    block.environment[local] = pairs.environment[k];
                    block.blocked[local] = pairs.blocked[k];
                    block.begin[local + 1] += before_[std::size_t{k} * (chunks_ + 1) + chunks_];
                }
            }
            block.columns.resize(block.begin.back());
            block.values.resize(block.begin.back());
            block.visibility.resize(block.begin.back());
        }
    }

    /// Number of threads' shares of the columns.
    [[nodiscard]] std::uint32_t chunks() const { return chunks_; }

    /// Pairs of i with the patches j >= i of a chunk: entry (i, j), and entry (j, i), whose columns come in
    /// ascending order if rows i do.
    void fill(std::uint32_t i, std::uint32_t chunk) {
        const std::uint32_t from = chunk * columns_at_once;
        const std::uint32_t upto = std::min(from + columns_at_once, images_.size());
        const std::uint32_t k = pairs_.index.row_of(i);
        if (upto <= i) {
            return;
        }
        if (k == RowIndex::no_row) { // only the rows that were asked for have this column
            for (std::uint32_t j = std::max(from, i + 1); j < upto; ++j) {
                const std::uint32_t other = pairs_.index.row_of(j);
                if (other != RowIndex::no_row && is_seen(other, i)) {
                    const Exchange exchange = add_up(other, j, i);
                    put(blocks_[j / FormFactorMatrix::block_rows], next_[j]++, i, exchange.area / area(j),
                        exchange.visibility);
                }
            }
            return;
        }
        RowBlock& block = blocks_[i / FormFactorMatrix::block_rows];
        std::uint64_t at = block.begin[i - block.first_row] + before_[std::size_t{k} * (chunks_ + 1) + chunk];
        for (std::uint32_t j = from; j < upto; ++j) {
            if (!is_seen(k, j)) {
                continue;
            }
            const std::uint64_t here = at++;
            if (j < i) {
                continue;
            }
            const Exchange exchange = add_up(k, i, j);
            put(block, here, j, exchange.area / area(i), exchange.visibility);
            if (j > i && pairs_.index.row_of(j) != RowIndex::no_row) {
                put(blocks_[j / FormFactorMatrix::block_rows], next_[j]++, i, exchange.area / area(j),
                    exchange.visibility);
            }
        }
    }

private:
    /// What a patch and all images of another exchange.
    struct Exchange {
        double area; ///< A_i F(i, j)
        std::uint8_t visibility;
    };

    void count(std::size_t k) {
        for (std::uint32_t chunk = 0; chunk < chunks_; ++chunk) {
            std::uint32_t seen = 0;
            const std::uint32_t from = chunk * columns_at_once;
            for (std::uint32_t j = from; j < std::min(from + columns_at_once, images_.size()); ++j) {
                seen += is_seen(k, j) ? 1 : 0;
            }
            std::uint32_t* const before = before_.data() + k * (chunks_ + 1) + chunk;
            before[1] = before[0] + seen;
        }
    }

    [[nodiscard]] double area(std::uint32_t i) const { return images_.mesh().areas()[i]; }

    /// Whether row k sees something of some image of j.
    [[nodiscard]] bool is_seen(std::size_t k, std::uint32_t j) const {
        for (std::uint32_t image = 0; image < images_.images(); ++image) {
            if (!pairs_.visibility[k][images_.patch(image, j)].is_hidden()) {
                return true;
            }
        }
        return false;
    }

    /// @param k  row of i
    [[nodiscard]] Exchange add_up(std::size_t k, std::uint32_t i, std::uint32_t j) const {
        double exchange = 0.0;
        double unoccluded = 0.0; // with what is hidden: V of all is the share of it
        bool clear = true;
        for (std::uint32_t image = 0; image < images_.images(); ++image) {
            const std::uint32_t patch = images_.patch(image, j);
            if (const double one = patch == i ? 0.0 : exchange_areas_(i, patch); one > 0.0) {
                const PairVisibility visibility = pairs_.visibility[k][patch];
                unoccluded += one;
                exchange += one * visibility.value();
                clear = clear && visibility.stored() == visibility_clear;
            }
        }
        const PairVisibility all = clear              ? PairVisibility::clear()
                                   : unoccluded > 0.0 ? PairVisibility::from(exchange / unoccluded)
                                                      : PairVisibility();
        return {exchange, all.stored()};
    }

    const PairTable& pairs_;
    const ImageMesh& images_;
    const ExchangeAreas& exchange_areas_;
    std::vector<RowBlock>& blocks_;
    std::uint32_t chunks_;
    std::vector<std::uint32_t> before_; ///< of every row: entries before each chunk, and all
    std::vector<std::uint64_t> next_; ///< where the next entry of a row goes below the diagonal, in its block
};

/// Factors of patches and all images of others.
FormFactorMatrix assemble_folded(const PairTable& pairs, const ImageMesh& images,
                                 const ExchangeAreas& exchange_areas, const Progress& progress) {
    FormFactorMatrix matrix(images.size());
    std::vector<RowBlock> blocks(matrix.blocks().begin(), matrix.blocks().end());
    FoldedFiller filler(pairs, images, exchange_areas, blocks);
    for (RowBlock& block : blocks) {
        const std::uint32_t first = block.first_row;
        const std::uint32_t end = first + block.rows();
        parallel_for(filler.chunks(), 1, [&](std::size_t from, std::size_t upto) {
            for (auto chunk = static_cast<std::uint32_t>(from); chunk < upto; ++chunk) {
                for (std::uint32_t i = first; i < end; ++i) {
                    filler.fill(i, chunk);
                }
            }
        });
        drop_zeros(block);
        matrix.set_block(std::move(block));
        if (progress && !progress(end, images.size())) {
            throw Cancelled();
        }
    }
    return matrix;
}

/// Factors of the patches of a scene without images.
FormFactorMatrix assemble_pairs(const PairTable& pairs, const PatchMesh& mesh,
                                const ExchangeAreas& exchange_areas, const Progress& progress) {
    const std::uint32_t size = mesh.size();
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
        drop_zeros(block);
        matrix.set_block(std::move(block));
        if (progress && !progress(end, size)) {
            throw Cancelled();
        }
    }
    return matrix;
}

/// What all rows know of the environment.
class Evidence {
public:
    /// All must outlive this.
    Evidence(const PairTable& pairs, const ImageMesh& images, ExchangeRule rule, Enclosure enclosure)
        : pairs_(pairs), mesh_(images.mesh()), rule_(rule), facing_(mesh_) {
        if (enclosure == Enclosure::automatic) {
            space_.emplace(mesh_);
        }
        find_hiding();
    }

    /// @param k  of a patch that has a row
    [[nodiscard]] EnvironmentEvidence of_row(const FormFactorMatrix& matrix, std::size_t k) const {
        const std::uint32_t i = pairs_.index.patches()[k];
        if (space_ && space_->encloses(i)) {
            return {.texels = pairs_.environment[k], .enclosed = true};
        }
        return evidence_of(matrix.row(i), hides_[k] != 0, rule_);
    }

    /// The same with factors by the exact rule.
    [[nodiscard]] EnvironmentEvidence exactly(const FormFactorMatrix& matrix, std::size_t k) const {
        const std::uint32_t i = pairs_.index.patches()[k];
        const ExchangeAreas exact(mesh_, ExchangeRule::exact);
        double sum = 0.0;
        const std::vector<PairVisibility> visibility = row_of_all(k);
        for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
            if (const PairVisibility pair = visibility[j]; j != i && !pair.is_hidden()) {
                sum += exact(i, j) / mesh_.areas()[i] * pair.value();
            }
        }
        EnvironmentEvidence evidence = of_row(matrix, k);
        evidence.error +=
            (unoccluded_error(ExchangeRule::exact) - unoccluded_error(rule_)) * matrix.row(i).sum();
        evidence.remainder = 1.0 - pairs_.blocked[k] - sum;
        return evidence;
    }

private:
    /// Finds which rows face a patch that they see nothing of. Of ranks each knows pairs of its own rows; a
    /// row hides something where one of them says so.
    void find_hiding() {
        hides_.assign(pairs_.index.rows(), 0);
        parallel_for(hides_.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                hides_[k] = finds_hidden(k) ? 1 : 0;
            }
        });
        if (pairs_.own.divided()) {
            const std::vector<std::uint8_t> all =
                gather_values(ranks(), std::span<const std::uint8_t>(hides_));
            for (std::size_t k = 0; k < all.size(); ++k) {
                hides_[k % hides_.size()] |= all[k];
            }
        }
    }

    [[nodiscard]] bool finds_hidden(std::size_t k) const {
        const std::uint32_t i = pairs_.index.patches()[k];
        for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
            const std::optional<PairVisibility> pair = known_pair(k, j);
            if (pair && pair->is_hidden() && j != i && facing_(i, j)) {
                return true;
            }
        }
        return false;
    }

    /// V of row k and patch j, unless it is another rank's pair.
    [[nodiscard]] std::optional<PairVisibility> known_pair(std::size_t k, std::uint32_t j) const {
        if (!pairs_.own.divided()) {
            return pairs_.visibility[k][j];
        }
        const std::uint32_t i = pairs_.index.patches()[k];
        const std::uint32_t other = pairs_.index.row_of(j);
        if (j < i && other != RowIndex::no_row) {
            return pairs_.own.contains(other) ? std::optional(pairs_.visibility[other][i]) : std::nullopt;
        }
        return pairs_.own.contains(k) ? std::optional(pairs_.visibility[k][j]) : std::nullopt;
    }

    /// V of a row and all patches, whoever knows it. All ranks ask for the same row.
    [[nodiscard]] std::vector<PairVisibility> row_of_all(std::size_t k) const {
        std::vector<PairVisibility> row(mesh_.size());
        for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
            row[j] = known_pair(k, j).value_or(PairVisibility());
        }
        if (pairs_.own.divided()) {
            const std::vector<PairVisibility> all =
                gather_values(ranks(), std::span<const PairVisibility>(row));
            for (std::size_t at = 0; at < all.size(); ++at) {
                if (!all[at].is_hidden()) {
                    row[at % row.size()] = all[at];
                }
            }
        }
        return row;
    }

    const PairTable& pairs_;
    const PatchMesh& mesh_;
    ExchangeRule rule_;
    FacingTest facing_;
    std::optional<EnclosedSpace> space_;
    std::vector<std::uint8_t> hides_; ///< of each row: whether it faces a patch that it sees nothing of
};

/// Sets the environment's share of all rows, which texels measured, to what the scene and the factors say.
void settle_environment(FormFactorMatrix& matrix, const PairTable& pairs, const ImageMesh& images,
                        ExchangeRule rule, Enclosure enclosure) {
    if (enclosure == Enclosure::closed) {
        return;
    }
    const Evidence evidence(pairs, images, rule, enclosure);
    std::vector<EnvironmentEvidence> rows(pairs.index.rows());
    parallel_for(rows.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            rows[k] = evidence.of_row(matrix, k);
        }
    });
    const bool open = is_open(rows, enclosure, [&](std::size_t k) { return evidence.exactly(matrix, k); });
    std::vector<RowBlock> blocks = matrix.take_blocks();
    for (RowBlock& block : blocks) {
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            if (const std::uint32_t k = pairs.index.row_of(block.first_row + local); k != RowIndex::no_row) {
                block.environment[local] = environment_share(rows[k], enclosure, open);
            }
        }
        matrix.set_block(std::move(block));
    }
}

} // namespace

void drop_zeros(RowBlock& block) {
    std::uint64_t kept = 0;
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        const std::uint64_t begin = block.begin[local];
        block.begin[local] = kept;
        for (std::uint64_t entry = begin; entry < block.begin[local + 1]; ++entry) {
            if (block.values[entry] > 0.0f) {
                block.columns[kept] = block.columns[entry];
                block.values[kept] = block.values[entry];
                block.visibility[kept] = block.visibility[entry];
                ++kept;
            }
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

FormFactorMatrix assemble_factors(const PairTable& pairs, const ImageMesh& images, ExchangeRule rule,
                                  Enclosure enclosure, const Progress& progress) {
    const ExchangeAreas exchange_areas(images.mesh(), rule);
    FormFactorMatrix matrix = images.any() ? assemble_folded(pairs, images, exchange_areas, progress)
                              : pairs.own.divided()
                                  ? assemble_divided(pairs, images.mesh(), exchange_areas, progress)
                                  : assemble_pairs(pairs, images.mesh(), exchange_areas, progress);
    settle_environment(matrix, pairs, images, rule, enclosure);
    return matrix;
}

} // namespace hemi
