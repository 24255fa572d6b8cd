#include "hemi/io/image_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"

#include <fmt/format.h>
#include <stb_image_write.h>

#include <cmath>
#include <new>
#include <string>

namespace hemi::io {

namespace {

/// Takes the bytes of the C library, which exceptions must not cross.
struct Sink {
    std::string bytes;
    bool failed = false;

    static void take(void* self, void* data, int size) noexcept {
        auto& sink = *static_cast<Sink*>(self);
        try {
            sink.bytes.append(static_cast<const char*>(data), static_cast<std::size_t>(size));
        } catch (const std::bad_alloc&) {
            sink.failed = true;
        }
    }
};

void check_size(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                std::size_t values) {
    constexpr std::uint32_t largest = 16384; // the library counts bytes in int
    if (width == 0 || height == 0 || width > largest || height > largest) {
        throw InvalidArgument(fmt::format("{}: a picture of {} x {} pixels; each must be 1 to {}",
                                          path.string(), width, height, largest));
    }
    if (values != std::size_t{3} * width * height) {
        throw InvalidArgument(fmt::format("{}: {} values for a picture of {} x {} pixels; must be {}",
                                          path.string(), values, width, height,
                                          std::size_t{3} * width * height));
    }
}

void finish(const std::filesystem::path& path, const Sink& sink, int success) {
    if (success == 0 || sink.failed) {
        throw IoError(path.string() + ": cannot be written: not enough memory to compress the picture");
    }
    OutputFile file(path);
    file.write(sink.bytes);
    file.commit();
}

} // namespace

void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb) {
    check_size(path, width, height, rgb.size());
    Sink sink;
    const int w = static_cast<int>(width);
    const int h = static_cast<int>(height);
    finish(path, sink, stbi_write_png_to_func(&Sink::take, &sink, w, h, 3, rgb.data(), 3 * w));
}

void write_hdr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
    check_size(path, width, height, rgb.size());
    for (const float value : rgb) {
        if (!(value >= 0.0f) || !std::isfinite(value)) {
            throw InvalidArgument(
                fmt::format("{}: pixel value {}; must be finite and not negative", path.string(), value));
        }
    }
    Sink sink;
    const int success = stbi_write_hdr_to_func(&Sink::take, &sink, static_cast<int>(width),
                                               static_cast<int>(height), 3, rgb.data());
    finish(path, sink, success);
}

} // namespace hemi::io
