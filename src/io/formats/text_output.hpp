#pragma once

#include "hemi/io/output_file.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <utility>

namespace hemi::io {

/// Formatted text to a file through a buffer, for files of many millions of lines.
class TextOutput {
public:
    explicit TextOutput(const std::filesystem::path& path) : file_(path) {}

    /// @param format  FMT_COMPILE("...")
    template <class Format, class... Values>
    void print(const Format& format, Values&&... values) {
        fmt::format_to(std::back_inserter(buffer_), format, std::forward<Values>(values)...);
        if (buffer_.size() > flush_at) {
            flush();
        }
    }
    void commit() {
        flush();
        file_.commit();
    }

private:
    static constexpr std::size_t flush_at = 1 << 18;

    void flush() {
        file_.write(buffer_.data(), buffer_.size());
        buffer_.clear();
    }

    OutputFile file_;
    fmt::memory_buffer buffer_;
};

/// A field of a CSV line: in quotes where it needs them.
[[nodiscard]] std::string csv_field(const std::string& text);

} // namespace hemi::io
