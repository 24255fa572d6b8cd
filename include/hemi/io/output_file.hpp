#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace hemi::io {

/// A file that appears under its name only when it is complete: writes go to a temporary name beside it,
/// commit() flushes, syncs and renames. Destroyed without commit(), nothing is left behind; what a process
/// left that was killed meanwhile is removed by the next one that writes a file of that name. The path "-"
/// writes to standard output.
class OutputFile {
public:
    /// Opens the temporary file, empty.
    /// @throws IoError naming the path and the system's reason.
    explicit OutputFile(std::filesystem::path path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Appends text.
    /// @throws IoError, for example when the disk is full.
    void write(std::string_view text);
    /// Appends bytes.
    /// @throws IoError, for example when the disk is full.
    void write(const void* data, std::size_t bytes);
    /// Makes the file appear under its name, in place of one that is there. Nothing is written afterwards.
    /// @throws IoError; the old file is then still there.
    void commit();

private:
    void release() noexcept;

    std::filesystem::path path_;
    std::filesystem::path temporary_;
    int lock_ = -1; ///< descriptor of the temporary file, locked as long as it is there
    std::FILE* stream_ = nullptr;
};

/// The whole file as bytes.
/// @throws InputError naming the path and the reason (missing, a directory, not readable, larger than the
///   machine's memory).
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

} // namespace hemi::io
