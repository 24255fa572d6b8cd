#pragma once

#include "hemi/engine/engine.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

namespace hemi {

namespace io {
class CheckpointFile;
}
class Observer;
struct RowBlock;

/// Rows that outlast a run which is interrupted or killed: finished blocks of raw hemicube rows, or of rows
/// of clusters before they balance, kept in OUTPUT.rows beside the file of form factors that a run is to
/// write, until that is complete. Analytic factors and error estimates are computed again. Of several ranks
/// (hemi::Ranks) each keeps its own rows, the K-th of N in OUTPUT.KofN.rows, where as many ranks find them
/// again.
class RowCheckpoint {
public:
    /// @param output  the file of form factors that is to be written
    /// @param resume  use the rows that an earlier run left; else they are removed
    /// @throws IoError with `resume` if what is there cannot be used
    RowCheckpoint(const std::filesystem::path& output, bool resume);
    ~RowCheckpoint();
    RowCheckpoint(const RowCheckpoint&) = delete;
    RowCheckpoint& operator=(const RowCheckpoint&) = delete;

    /// The file that rows are kept in.
    [[nodiscard]] const std::filesystem::path& path() const;
    /// Rows that are in it.
    [[nodiscard]] std::uint64_t rows() const;
    /// Rows that an earlier run had computed and this one used.
    [[nodiscard]] std::uint64_t reused() const noexcept { return reused_; }
    /// The output is complete: removes the file.
    void discard() noexcept;
    /// The same where rows of another mesh come next, which are to be kept as well.
    void start_over() noexcept;

private:
    template <class Row>
    friend class ObservedRows;
    friend class KeptClusteredRows;
    /// Says how many of so many rows came from the file, if there are any.
    void tell_reused(std::size_t rows, Observer& observer) const;
    /// Keeps a finished block; warns where that cannot be written.
    void append(const RowBlock& block, std::span<const std::uint8_t> marks, Observer& observer);

    std::unique_ptr<io::CheckpointFile> file_;
    std::uint64_t reused_ = 0;
};

} // namespace hemi
