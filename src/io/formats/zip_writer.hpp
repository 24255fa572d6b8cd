#pragma once

#include "hemi/io/output_file.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Writes a ZIP archive of stored members to any output, front to back, with 64-bit sizes throughout
/// (as NumPy does). libzip, which reads them, can only write to a file by name and asks for every byte twice
/// too.
class ZipWriter {
public:
    using Sink = std::function<void(std::span<const std::byte>)>;
    /// Hands a member's bytes to the sink in order; called twice (checksum, then bytes), must do the same.
    using Source = std::function<void(const Sink&)>;

    explicit ZipWriter(OutputFile& file) : file_(file) {}

    void add(const std::string& name, const Source& source);
    /// Writes the directory. The file is not committed.
    void finish();

private:
    struct Member {
        std::string name;
        std::uint32_t crc = 0;
        std::uint64_t size = 0;
        std::uint64_t offset = 0;
    };

    void write(const std::string& bytes);

    OutputFile& file_;
    std::vector<Member> members_;
    std::uint64_t position_ = 0;
};

} // namespace hemi::io
