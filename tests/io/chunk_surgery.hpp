#pragma once

#include <catch2/catch.hpp>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>

/// Changes chunk files as a liar would, who knows how checksums are made.
namespace hemi::io_test {

/// Where chunk `index` starts.
inline std::size_t chunk_start(const std::string& bytes, int index) {
    std::size_t start = 16;
    for (; index > 0; --index) {
        std::uint64_t length = 0;
        std::memcpy(&length, bytes.data() + start + 8, 8);
        start += 16 + (length + 7) / 8 * 8;
    }
    return start;
}

/// The file with one chunk's payload changed in place and its checksum made right again.
inline std::string with_payload(std::string bytes, int chunk, std::size_t offset, const std::string& change) {
    const std::size_t start = chunk_start(bytes, chunk);
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + start + 8, 8);
    REQUIRE(offset + change.size() <= length);
    bytes.replace(start + 16 + offset, change.size(), change);
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data()) + start;
    auto crc = crc32_z(0, data, 4);
    crc = crc32_z(crc, data + 8, 8);
    const auto whole = static_cast<std::uint32_t>(crc32_z(crc, data + 16, length));
    std::memcpy(bytes.data() + start + 4, &whole, 4);
    return bytes;
}

template <class T>
std::string raw(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

} // namespace hemi::io_test
