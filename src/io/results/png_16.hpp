#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace hemi::io {

/// A PNG of 16 bits a channel, marked as sRGB, as bytes of its file.
/// @param rgb  rows from the top, 3 values a pixel
/// @throws OutOfMemory; InvalidArgument for another number of values
[[nodiscard]] std::string png_of_16_bits(std::uint32_t width, std::uint32_t height,
                                         std::span<const std::uint16_t> rgb);

} // namespace hemi::io
