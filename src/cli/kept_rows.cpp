#include "cli/kept_rows.hpp"

#include "cli/report.hpp"
#include "engine/open_block.hpp"
#include "engine/raw_row.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace hemi::cli {

/// Rows of another provider, those that are kept from the journal.
template <class Row>
class KeptRows::Provider : public BasicRowProvider<Row> {
public:
    Provider(KeptRows& kept, BasicRowProvider<Row>& provider, io::CheckpointKey key)
        : kept_(kept), provider_(provider), key_(std::move(key)) {}

    [[nodiscard]] std::uint32_t size() const override { return provider_.size(); }
    [[nodiscard]] std::string renderer() const override { return provider_.renderer(); }

    void rows(std::span<const std::uint32_t> patches,
              const typename BasicRowProvider<Row>::Sink& sink) override {
        std::vector<bool> there(size(), false);
        io::CheckpointFile& journal = *kept_.journal_;
        key_["renderer"] = renderer(); // others give other bits
        journal.start(key_, size(), [&](std::uint32_t patch, const RawRow& row) {
            there[patch] = true;
            ++kept_.reused_;
            sink(patch, row_from_raw<Row>(row));
        });
        if (kept_.reused_ > 0) {
            kept_.terminal_.note(fmt::format("{} of {} from {}", count_text(kept_.reused_),
                                             plural(size(), "row", "rows"), journal.path().string()));
        }
        std::vector<std::uint32_t> missing;
        std::copy_if(patches.begin(), patches.end(), std::back_inserter(missing),
                     [&there](std::uint32_t patch) { return !there[patch]; });
        if (!missing.empty()) {
            compute(missing, sink);
        }
    }

private:
    void compute(std::span<const std::uint32_t> missing, const typename BasicRowProvider<Row>::Sink& sink) {
        std::map<std::uint32_t, OpenBlock> open;
        std::size_t expected_entries = 0; // of a block: what the last one had, and a little more
        provider_.rows(missing, [&](std::uint32_t patch, const Row& row) {
            const std::uint32_t first = patch - patch % FormFactorMatrix::block_rows;
            const std::uint32_t count = std::min(FormFactorMatrix::block_rows, size() - first);
            OpenBlock& block =
                open.try_emplace(first, first, count, rows_of_block(missing, first), expected_entries)
                    .first->second;
            block.add(patch, raw_row(row));
            if (block.complete()) {
                const RowBlock finished = block.finish();
                expected_entries = finished.columns.size() + finished.columns.size() / 16;
                append(finished);
                open.erase(first);
            }
            sink(patch, row);
        });
    }

    void append(const RowBlock& block) {
        try {
            kept_.journal_->append(block);
        } catch (const IoError& error) {
            kept_.terminal_.warn(fmt::format("{}; this run cannot be resumed", error.what()));
        }
    }

    KeptRows& kept_;
    BasicRowProvider<Row>& provider_;
    io::CheckpointKey key_;
};

KeptRows::KeptRows(const std::optional<std::filesystem::path>& output, bool resume, const Terminal& terminal)
    : terminal_(terminal) {
    if (output) {
        journal_.emplace(*output, resume);
    }
}

template <class Row>
std::unique_ptr<BasicRowProvider<Row>> KeptRows::keep(BasicRowProvider<Row>& provider,
                                                      io::CheckpointKey key) {
    size_ = provider.size();
    return std::make_unique<Provider<Row>>(*this, provider, std::move(key));
}
template std::unique_ptr<RowProvider> KeptRows::keep(RowProvider&, io::CheckpointKey);
template std::unique_ptr<VisibilityProvider> KeptRows::keep(VisibilityProvider&, io::CheckpointKey);

void KeptRows::discard() noexcept {
    if (journal_) {
        journal_->remove();
    }
}

void KeptRows::tell() const {
    if (journal_ && journal_->rows() > 0) {
        terminal_.note(fmt::format(
            "{} of {} are kept in {}; the same command with --resume goes on from there",
            count_text(journal_->rows()), plural(size_, "row", "rows"), journal_->path().string()));
    }
}

} // namespace hemi::cli
