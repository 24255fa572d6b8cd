#include "viewer/command_line.hpp"

#include <fmt/format.h>

#include <string_view>

namespace hemi::viewer {

std::string quantity_options(const Look& look, const FalseColours& drawn) {
    std::string text = fmt::format(" --show {} --channel {} --map {}", to_word(look.shown.quantity),
                                   quoted(look.channel), to_word(drawn.map));
    text += look.range ? fmt::format(" --range {},{}", (*drawn.range)[0], (*drawn.range)[1]) : "";
    text += drawn.logarithmic ? " --log" : "";
    text += drawn.bands > 0 ? fmt::format(" --bands {}", drawn.bands) : "";
    text += drawn.iso_lines ? " --iso-lines" : "";
    text += look.celsius && !shows_difference(look) && look.shown.quantity == Quantity::temperature
                ? " --celsius"
                : "";
    return text;
}

std::string picture_options(const PictureSettings& settings, const Camera& camera, bool lit,
                            std::span<const std::string> groups) {
    const auto point = [](const Vec3& p) { return fmt::format("{},{},{}", p.x, p.y, p.z); };
    std::string text = fmt::format(" --size {}x{} --camera {}:{}:{}:{}", settings.width, settings.height,
                                   point(camera.eye), point(camera.target), point(camera.up), camera.fov);
    if (lit) {
        text += fmt::format(" --exposure {} --tone-mapping {}", settings.exposure,
                            settings.tone_mapping == ToneMapping::filmic ? "filmic" : "linear");
        text += settings.shading == Shading::flat ? " --flat" : "";
    }
    text += camera.orthographic ? " --orthographic" : "";
    text += settings.outlines ? " --outlines" : "";
    text += settings.backs ? " --backs" : "";
    for (std::uint32_t g = 0; g < groups.size(); ++g) {
        const Visibility visibility = settings.cut.of_group(g);
        if (visibility != Visibility::shown) {
            text += (visibility == Visibility::hidden ? " --hide " : " --outlines-of ") + quoted(groups[g]);
        }
    }
    text += settings.cut.clip ? " --clip " + quoted(clip_plane_text(*settings.cut.clip)) : "";
    if (settings.background) {
        const auto& [red, green, blue] = *settings.background;
        text += fmt::format(" --background '#{:02x}{:02x}{:02x}'", red, green, blue);
    }
    text +=
        settings.samples != PictureSettings{}.samples ? fmt::format(" --samples {}", settings.samples) : "";
    return text;
}

std::string quoted(const std::string& word) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:,=+";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
        return word;
    }
    std::string text = "'";
    for (const char letter : word) {
        text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    }
    return text + "'";
}

} // namespace hemi::viewer
