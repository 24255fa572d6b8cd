#include "support/png.hpp"

#include <stdexcept>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb_image.h>

namespace hemi::test {

SrgbPicture read_png(const std::string& path) {
    int width = 0;
    int height = 0;
    int channels = 0;
    stbi_uc* data = stbi_load(path.c_str(), &width, &height, &channels, 3);
    if (data == nullptr) {
        throw std::runtime_error(path + ": not a picture");
    }
    SrgbPicture picture{static_cast<std::size_t>(width), static_cast<std::size_t>(height), {}};
    picture.pixels.assign(data, data + picture.width * picture.height * 3);
    stbi_image_free(data);
    return picture;
}

DeepPicture read_png_16(const std::string& bytes) {
    const auto* first = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int length = static_cast<int>(bytes.size());
    int width = 0;
    int height = 0;
    int channels = 0;
    stbi_us* data = stbi_is_16_bit_from_memory(first, length) != 0
                        ? stbi_load_16_from_memory(first, length, &width, &height, &channels, 3)
                        : nullptr;
    if (data == nullptr) {
        throw std::runtime_error("not a picture of 16 bits");
    }
    DeepPicture picture{static_cast<std::size_t>(width), static_cast<std::size_t>(height), {}};
    picture.pixels.assign(data, data + picture.width * picture.height * 3);
    stbi_image_free(data);
    return picture;
}

} // namespace hemi::test
