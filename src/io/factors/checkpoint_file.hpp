#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace hemi::io {

/// What the rows of a checkpoint belong to: names and values, all of which must be equal for rows to be used.
using CheckpointKey = std::map<std::string, std::string>;
/// The name of what rows hold.
inline constexpr const char* kind_of_rows = "rows of";

/// Two keys that differ, told by the first name of which they do, kind_of_rows before all others; what has
/// none has the value "nothing".
struct KeyDifference {
    std::string name;
    std::string here;
    std::string there;
};
[[nodiscard]] std::optional<KeyDifference> difference(const CheckpointKey& here, const CheckpointKey& there);

/// Finished blocks of raw rows, kept beside a file of form factors while that is not complete, so that a run
/// that was killed can be taken up again: FILE.rows.
///
/// A chunk file (see chunk_file.hpp): `HEAD`, the key as JSON, then a `ROWS` a block, in the order in which
/// they were finished, each handed to the system at once. Before each stands a `MARK`, one byte a row, 0 or
/// 1, where columns may be clusters. A tail that was cut by the end of a process (or of the machine) is
/// dropped. Locked while a run uses it. Appears with its first block, so that a run that finished none leaves
/// nothing behind.
class CheckpointFile {
public:
    /// Looks for the checkpoint of `output`. What another run is using, and files that are no checkpoints,
    /// are left alone; this one then keeps nothing.
    /// @param resume  use what is there; else it is removed
    /// @throws IoError with `resume` if it is in use or no checkpoint
    CheckpointFile(const std::filesystem::path& output, bool resume);
    ~CheckpointFile();
    CheckpointFile(const CheckpointFile&) = delete;
    CheckpointFile& operator=(const CheckpointFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

    /// Takes a patch, its row, which is valid during the call only, and whether that is marked.
    using EachRow = std::function<void(std::uint32_t, const RowView&, bool)>;

    /// Gives every row of the sound blocks that are there, and says what will be appended. Before append().
    /// @param rows  a matrix without known rows, that all of the file would fit into
    /// @throws InputError if what is there has another key, naming the first difference; what `each` throws
    void start(const CheckpointKey& key, FormFactorMatrix rows, const EachRow& each);

    /// @param block  of which rows are known that were not kept before
    /// @param marks  of its rows, where columns may be clusters; else none
    /// @throws IoError, for example when the disk is full; the checkpoint is then gone, and keeps nothing
    /// more.
    void append(const RowBlock& block, std::span<const std::uint8_t> marks = {});

    /// Rows in it.
    [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }

    /// The output is complete: removes the checkpoint.
    void remove() noexcept;
    /// The same, and another one may be started, unless none could be.
    void start_over() noexcept;

private:
    void write(const void* data, std::size_t bytes);
    [[noreturn]] void give_up(int error);

    std::filesystem::path path_;
    CheckpointKey key_;
    int descriptor_ = -1; ///< locked; -1: there is no checkpoint yet
    bool usable_ = true;  ///< whether this run may keep rows
    std::uint64_t rows_ = 0;
};

} // namespace hemi::io
