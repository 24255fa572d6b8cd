#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace hemi::io {

/// 8-bit sRGB, rows from the top, 3 bytes a pixel; by stb_image_write. @throws IoError
void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb);
/// Radiance .hdr, linear, rows from the top, 3 floats a pixel; by stb_image_write. @throws IoError
void write_hdr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb);

} // namespace hemi::io
