#include "io/results/png_16.hpp"

#include "hemi/core/error.hpp"

#include <zlib.h>

#include <cstddef>
#include <string_view>

namespace hemi::io {

namespace {

/// Big endian, as all of PNG.
void put_32(std::string& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes += static_cast<char>(value >> shift & 0xFF);
    }
}

/// Source: Portable Network Graphics Specification, W3C 2003, 5.3.
void put_chunk(std::string& bytes, std::string_view type, std::string_view data) {
    put_32(bytes, static_cast<std::uint32_t>(data.size()));
    const std::size_t checked = bytes.size();
    bytes += type;
    bytes += data;
    put_32(bytes, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + checked),
                                                   static_cast<uInt>(bytes.size() - checked))));
}

} // namespace

std::string png_of_16_bits(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgb) {
    const std::size_t row = std::size_t{width} * 3;
    if (rgb.size() != row * height || rgb.empty()) {
        throw InvalidArgument("a picture of another number of pixels");
    }
    std::string lines; // each with its filter: none in the first, the one above in all others
    lines.reserve((row * 2 + 1) * height);
    for (std::uint32_t y = 0; y < height; ++y) {
        constexpr char of_above = 2;
        lines += y == 0 ? '\0' : of_above;
        for (std::size_t k = 0; k < row; ++k) {
            const std::uint16_t value = rgb[y * row + k];
            const std::uint16_t above = y == 0 ? std::uint16_t{0} : rgb[(y - 1) * row + k];
            lines += static_cast<char>((value >> 8) - (above >> 8)); // bytes by themselves, modulo 256
            lines += static_cast<char>((value & 0xFF) - (above & 0xFF));
        }
    }
    std::string packed(compressBound(static_cast<uLong>(lines.size())), '\0');
    uLongf packed_size = static_cast<uLongf>(packed.size());
    if (compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_size,
                  reinterpret_cast<const Bytef*>(lines.data()), static_cast<uLong>(lines.size()),
                  Z_DEFAULT_COMPRESSION) != Z_OK) {
        throw OutOfMemory("a picture is too large to be compressed");
    }
    packed.resize(packed_size);
    std::string bytes("\x89PNG\r\n\x1A\n", 8);
    std::string head;
    put_32(head, width);
    put_32(head, height);
    head += std::string("\x10\x02\0\0\0", 5); // 16 bits, RGB, deflate, adaptive filters, not interlaced
    put_chunk(bytes, "IHDR", head);
    put_chunk(bytes, "sRGB", std::string(1, '\0'));
    put_chunk(bytes, "IDAT", packed);
    put_chunk(bytes, "IEND", {});
    return bytes;
}

} // namespace hemi::io
