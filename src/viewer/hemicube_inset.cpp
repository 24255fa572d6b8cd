#include "viewer/hemicube_inset.hpp"

#include "display/legend.hpp"
#include "gl/context.hpp"

#include <algorithm>
#include <cmath>

namespace hemi::viewer {

namespace {

/// Pixels along an edge of the texture at most.
constexpr std::uint32_t largest_picture = 1024;

using Bytes = std::array<std::uint8_t, 4>;
constexpr Bytes corner_bytes{0, 0, 0, 0};
constexpr Bytes nothing_bytes{44, 44, 44, 255};
constexpr Bytes blocked_bytes{96, 20, 24, 255};

Bytes encode(const std::array<float, 3>& linear) {
    Bytes bytes{0, 0, 0, 255};
    for (std::size_t c = 0; c < 3; ++c) {
        bytes[c] = srgb_of(linear[c]);
    }
    return bytes;
}

} // namespace

HemicubeInset::HemicubeInset(const PatchMesh& mesh, const HemicubeSettings& settings, gl::Context& window)
    : HemicubeInset(ImageMesh(mesh), settings, window) {}

HemicubeInset::HemicubeInset(const ImageMesh& images, const HemicubeSettings& settings, gl::Context& window)
    : settings_(settings), geometry_(make_engine_geometry(images.mesh(), settings_)),
      rows_(geometry_, settings_, window) {
    for (std::uint32_t patch = 0; patch < images.mesh().size(); ++patch) {
        original_.push_back(images.original(patch));
    }
}

void HemicubeInset::look(std::uint32_t patch, std::uint32_t eye) {
    const auto eyes = static_cast<std::uint32_t>(geometry_.eyes.of(patch).size());
    eye = eye < eyes ? eye : 0;
    if (patch == patch_ && eye == eye_) {
        return;
    }
    items_ = rows_.items(patch, eye);
    patch_ = patch;
    eye_ = eye;
}

std::optional<std::uint32_t> HemicubeInset::item_at(double x, double y) const {
    // Heights of the cube, from the middle of the top; the top reaches from -1 to 1 and a side 1 farther.
    // Looking along the normal, the frame's x points to the left where its y points up.
    const double across = 2.0 - 4.0 * x;
    const double upwards = 2.0 - 4.0 * y;
    int face = 0;
    double right = across;
    double up = upwards;
    if (std::max(std::abs(across), std::abs(upwards)) > 1.0) {
        if (std::min(std::abs(across), std::abs(upwards)) > 1.0) {
            return std::nullopt;
        }
        // See face_direction(): each side's own right, along the edge that it shares with the top.
        if (std::abs(across) > 1.0) {
            face = across > 0.0 ? 1 : 3;
            right = across > 0.0 ? upwards : -upwards;
            up = 2.0 - std::abs(across);
        } else {
            face = upwards > 0.0 ? 2 : 4;
            right = upwards > 0.0 ? -across : across;
            up = 2.0 - std::abs(upwards);
        }
    }
    const std::uint32_t edge = settings_.resolution;
    const auto texel = [edge](double place) {
        return std::min(static_cast<std::uint32_t>(std::max(0.0, 0.5 * place * edge)), edge - 1);
    };
    const std::uint32_t column = texel(right + 1.0);
    const std::uint32_t row = face == 0 ? texel(up + 1.0)
                                        : edge + static_cast<std::uint32_t>(face - 1) * (edge / 2) +
                                              std::min(texel(up), edge / 2 - 1);
    const std::uint32_t item = items_[std::size_t{row} * edge + column];
    return item < item_first_patch ? item : item_first_patch + original_[item - item_first_patch];
}

void HemicubeInset::paint(std::span<const std::array<float, 3>> colours,
                          const std::optional<std::array<float, 3>>& environment) {
    const Bytes nothing = environment ? encode(*environment) : nothing_bytes;
    const std::uint32_t edge = std::min(2 * settings_.resolution, largest_picture);
    std::vector<Bytes> patch_bytes;
    patch_bytes.reserve(colours.size());
    for (const auto& colour : colours) {
        patch_bytes.push_back(encode(colour));
    }
    std::vector<Bytes> pixels;
    pixels.reserve(std::size_t{edge} * edge);
    for (std::uint32_t y = 0; y < edge; ++y) {
        for (std::uint32_t x = 0; x < edge; ++x) {
            const auto item = item_at((x + 0.5) / edge, (y + 0.5) / edge);
            pixels.push_back(!item                   ? corner_bytes
                             : *item == item_nothing ? nothing
                             : *item == item_blocked ? blocked_bytes
                                                     : patch_bytes[*item - item_first_patch]);
        }
    }
    texture_ = gl::Texture2D();
    const auto size = static_cast<GLsizei>(edge);
    glTextureStorage2D(texture_.get(), 1, GL_RGBA8, size, size);
    glTextureSubImage2D(texture_.get(), 0, 0, 0, size, size, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    glTextureParameteri(texture_.get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture_.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl::label(GL_TEXTURE, texture_.get(), "hemicube inset");
    gl::check_errors("drawing a hemicube");
}

std::vector<std::uint32_t> HemicubeInset::seen() const {
    std::vector<std::uint32_t> patches;
    const std::uint32_t edge = 2 * settings_.resolution;
    for (std::uint32_t y = 0; y < edge; ++y) {
        for (std::uint32_t x = 0; x < edge; ++x) {
            const auto item = item_at((x + 0.5) / edge, (y + 0.5) / edge);
            if (item && *item >= item_first_patch) {
                patches.push_back(*item - item_first_patch);
            }
        }
    }
    std::sort(patches.begin(), patches.end());
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    return patches;
}

HemicubePicture HemicubeInset::picture() const {
    return {texture_.get(), patch_, settings_.resolution,
            static_cast<std::uint32_t>(geometry_.eyes.of(patch_).size())};
}

} // namespace hemi::viewer
