#pragma once

#include "cli/terminal.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "io/factors/checkpoint_file.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

/// Rows that outlast a run which is interrupted or killed: `--resume`.
namespace hemi::cli {

/// Keeps finished blocks of raw rows beside the file of form factors that a run is to write, until that is
/// complete.
class KeptRows {
public:
    /// @param output  the file; none: nothing is kept
    /// @param resume  take up what an earlier run left; else that is removed
    /// @throws IoError with `resume` if what is there cannot be used
    KeptRows(const std::optional<std::filesystem::path>& output, bool resume, const Terminal& terminal);

    /// Whether there is an output that rows are kept for.
    [[nodiscard]] bool active() const noexcept { return journal_.has_value(); }

    /// A provider of the same rows, which takes those that were kept from there and keeps all others.
    /// @tparam Row      RowView or VisibilityRow
    /// @param provider  of all rows; must outlive what is returned, as must this
    template <class Row>
    [[nodiscard]] std::unique_ptr<BasicRowProvider<Row>> keep(BasicRowProvider<Row>& provider,
                                                              io::CheckpointKey key);

    /// Rows that an earlier run had computed.
    [[nodiscard]] std::uint64_t reused() const noexcept { return reused_; }

    /// The output is complete.
    void discard() noexcept;
    /// The run failed: tells what is kept, if anything is, and how to go on from there.
    void tell() const;

private:
    template <class Row>
    class Provider;

    const Terminal& terminal_;
    std::optional<io::CheckpointFile> journal_;
    std::uint32_t size_ = 0;
    std::uint64_t reused_ = 0;
};

/// Calls work(kept) and returns what it does; where it fails, says what was kept.
template <class Work>
auto keeping_rows(const std::optional<std::filesystem::path>& output, bool resume, const Terminal& terminal,
                  Work&& work) {
    KeptRows kept(output, resume, terminal);
    try {
        return work(kept);
    } catch (...) {
        kept.tell();
        throw;
    }
}

} // namespace hemi::cli
