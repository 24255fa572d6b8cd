#pragma once

#include "hemi/io/output_file.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hemi::io {

/// What the first 16 bytes of a chunk file say: 8 bytes that no text file starts with (they end in CR LF, so
/// that a transfer as text is noticed), the version, four zero bytes.
struct ChunkFormat {
    std::string_view magic;   ///< 8 bytes
    std::uint32_t version;    ///< the one that is written, and the only one that is read
    std::string_view meaning; ///< for messages: "form factors (.hff)"
};

/// Bytes of an array or a trivial value.
template <class T, class Allocator>
[[nodiscard]] std::span<const std::byte> bytes_of(const std::vector<T, Allocator>& values) {
    return std::as_bytes(std::span(values));
}
template <class T>
[[nodiscard]] std::span<const std::byte> bytes_of(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span(&value, 1));
}
[[nodiscard]] inline std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

/// Takes what a chunk file is made of, front to back.
using ByteSink = std::function<void(const void* data, std::size_t bytes)>;
/// The first 16 bytes.
void write_start(const ByteSink& sink, const ChunkFormat& format);
/// One chunk whose payload is the parts one after another.
void write_chunk(const ByteSink& sink, std::string_view tag,
                 std::initializer_list<std::span<const std::byte>> parts);

/// Writes hemi's binary container: after the 16 bytes, chunks of a 4-byte tag, a CRC-32 (over tag, length and
/// payload), the payload's length in 64 bits, the payload, zeros up to a multiple of 8 bytes. The last
/// one is an empty `END `. Little endian.
class ChunkWriter {
public:
    ChunkWriter(const std::filesystem::path& path, const ChunkFormat& format);
    ChunkWriter(const ChunkWriter&) = delete;
    ChunkWriter& operator=(const ChunkWriter&) = delete;

    /// One chunk whose payload is the parts one after another.
    void chunk(std::string_view tag, std::initializer_list<std::span<const std::byte>> parts);
    /// For those who write a chunk by other means.
    [[nodiscard]] const ByteSink& sink() const noexcept { return sink_; }
    /// Writes the end; the file appears under its name.
    void finish();

private:
    OutputFile file_;
    ByteSink sink_;
};

/// A chunk's payload, taken apart from front to back.
class Payload {
public:
    Payload(std::string bytes, std::string place) : bytes_(std::move(bytes)), place_(std::move(place)) {}

    template <class T>
    [[nodiscard]] T take() {
        T value;
        copy(&value, sizeof value);
        return value;
    }
    /// @throws InputError if fewer than `count` are left; nothing is allocated then.
    template <class T, class Allocator = std::allocator<T>>
    [[nodiscard]] std::vector<T, Allocator> take_array(std::uint64_t count) {
        if (count > left() / sizeof(T)) {
            fail_short();
        }
        std::vector<T, Allocator> values(count);
        copy(values.data(), count * sizeof(T));
        return values;
    }
    [[nodiscard]] std::string_view text() const { return bytes_; }
    [[nodiscard]] std::uint64_t left() const { return bytes_.size() - used_; }
    /// @throws InputError unless all was taken.
    void expect_end() const;
    /// @throws InputError "file: chunk TAG: message"
    [[noreturn]] void fail(const std::string& message) const;

private:
    void copy(void* to, std::size_t size) {
        if (size > left()) {
            fail_short();
        }
        if (size != 0) {
            std::memcpy(to, bytes_.data() + used_, size);
        }
        used_ += size;
    }
    [[noreturn]] void fail_short() const;

    std::string bytes_;
    std::string place_;
    std::size_t used_ = 0;
};

/// Reads what ChunkWriter wrote, chunk by chunk. Any other bytes give an InputError, never more memory than
/// the file is long.
class ChunkReader {
public:
    ChunkReader(const std::filesystem::path& path, const ChunkFormat& format);

    /// The next chunk, whose tag must be `tag`.
    [[nodiscard]] Payload chunk(std::string_view tag);
    /// Reads the end; the file must end there too.
    void finish();

    [[nodiscard]] std::uint64_t file_size() const noexcept { return size_; }
    /// Where the next chunk starts.
    [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
    [[nodiscard]] const std::string& file() const noexcept { return file_; }
    /// @throws InputError "file: message"
    [[noreturn]] void fail(const std::string& message) const;

private:
    void read(void* to, std::size_t bytes);

    std::string file_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
    std::uint64_t size_ = 0;
    std::uint64_t position_ = 0;
};

} // namespace hemi::io
