#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// The bytes before the data of a NumPy array file: version 1.0, padded to 64 bytes.
/// @param type   NumPy's name of the element type: "<f4"
/// @param shape  as Python writes a tuple: "(3,)"
[[nodiscard]] std::string npy_header(std::string_view type, std::string_view shape);

/// A NumPy array file in memory: of no or one dimension, little endian.
class NpyArray {
public:
    /// @param name  of the file, for messages
    /// @throws InputError for anything else, and if the length is not that of the data.
    NpyArray(std::string bytes, std::string name);

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// Elements of "<i4" or "<i8"; @throws InputError for other types and negative values.
    [[nodiscard]] std::vector<std::uint64_t> integers() const;
    /// Elements of "<f4" or "<f8". @throws InputError for other types
    [[nodiscard]] std::vector<double> numbers() const;
    /// The only element of type "|S…" or "<U…", as ASCII. @throws InputError for other types
    [[nodiscard]] std::string text() const;

    /// @throws InputError "name: message"
    [[noreturn]] void fail(const std::string& message) const;

private:
    void read_description(std::string_view text);
    [[nodiscard]] std::size_t element_bytes() const;
    [[nodiscard]] std::string_view data() const { return std::string_view(bytes_).substr(start_); }

    std::string bytes_;
    std::string name_;
    std::string type_;
    std::size_t start_ = 0;
    std::size_t size_ = 1;
};

} // namespace hemi::io
