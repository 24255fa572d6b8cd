#pragma once

#include "hemi/io/output_file.hpp"

#include <bit>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

namespace hemi::io {

/// Numbers to a file through a buffer, little endian, and text between them.
class BinaryOutput {
public:
    explicit BinaryOutput(const std::filesystem::path& path) : file_(path) {}

    template <class Number>
    void put(Number number) {
        static_assert(std::endian::native == std::endian::little && std::is_arithmetic_v<Number>);
        buffer_.append(reinterpret_cast<const char*>(&number), sizeof number);
        if (buffer_.size() >= flush_at) {
            flush();
        }
    }
    void text(std::string_view text) { buffer_ += text; }
    void commit() {
        flush();
        file_.commit();
    }

private:
    static constexpr std::size_t flush_at = 1 << 18;

    void flush() {
        file_.write(buffer_);
        buffer_.clear();
    }

    OutputFile file_;
    std::string buffer_;
};

} // namespace hemi::io
