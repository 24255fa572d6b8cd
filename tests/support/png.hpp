#pragma once

#include "support/picture_difference.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hemi::test {

/// @throws std::runtime_error where there is no PNG
[[nodiscard]] SrgbPicture read_png(const std::string& path);

/// A picture of 16 bits a channel: red, green, blue, rows from the top.
struct DeepPicture {
    std::size_t width;
    std::size_t height;
    std::vector<std::uint16_t> pixels;
};
/// @param bytes  of the file
/// @throws std::runtime_error where they are no PNG of 16 bits
[[nodiscard]] DeepPicture read_png_16(const std::string& bytes);

} // namespace hemi::test
