#include "hemi/io/scene_writer.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/json_text.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::string_view blanks = " \t\r\n";

/// Where a string that begins at `at` ends.
std::size_t after_string(std::string_view text, std::size_t at) {
    for (++at; text[at] != '"'; ++at) {
        at += text[at] == '\\' ? 1 : 0;
    }
    return at + 1;
}

/// Where a value that begins at `at` ends.
std::size_t after_value(std::string_view text, std::size_t at) {
    int depth = 0;
    while (at < text.size()) {
        const char letter = text[at];
        if (depth == 0 && (letter == ',' || letter == '}')) {
            break;
        }
        depth += letter == '{' || letter == '[' ? 1 : (letter == '}' || letter == ']' ? -1 : 0);
        at = letter == '"' ? after_string(text, at) : at + 1;
    }
    const std::size_t last = text.find_last_not_of(blanks, at - 1);
    return last + 1;
}

/// First and one after the last byte of a member's value in the outermost object of a sound JSON text.
std::optional<std::pair<std::size_t, std::size_t>> find_member(std::string_view text, std::string_view key) {
    std::size_t at = text.find('{') + 1;
    while (true) {
        at = text.find_first_not_of(blanks, at);
        if (text[at] == '}') {
            return std::nullopt;
        }
        if (text[at] == ',') {
            ++at;
            continue;
        }
        const std::size_t key_end = after_string(text, at);
        const std::string_view name = text.substr(at + 1, key_end - at - 2);
        const std::size_t first = text.find_first_not_of(blanks, text.find(':', key_end) + 1);
        const std::size_t end = after_value(text, first);
        if (name == key) {
            return std::pair(first, end);
        }
        at = end;
    }
}

std::string camera_text(const Camera& camera) {
    const auto point = [](const Vec3& p) { return fmt::format("[{}, {}, {}]", p.x, p.y, p.z); };
    return fmt::format(R"({{"eye": {}, "target": {}, "up": {}, "fov": {}{}}})", point(camera.eye),
                       point(camera.target), point(camera.up), camera.fov,
                       camera.orthographic ? R"(, "orthographic": true)" : "");
}

} // namespace

void write_scene_camera(const std::filesystem::path& path, const Camera& camera) {
    if (path.extension() != ".json") {
        throw InvalidArgument(fmt::format("{}: only a JSON scene takes a camera", path.string()));
    }
    std::string text = read_file(path);
    const Json scene = parse_json(text, path.string());
    if (!scene.is_object() || scene.empty()) {
        throw InputError(fmt::format("{}: not a scene", path.string()));
    }
    if (const auto found = find_member(text, "camera")) {
        text.replace(found->first, found->second - found->first, camera_text(camera));
    } else {
        const std::size_t last = text.find_last_not_of(blanks, text.rfind('}') - 1);
        text.insert(last + 1, ",\n  \"camera\": " + camera_text(camera));
    }
    OutputFile file(path);
    file.write(text);
    file.commit();
}

} // namespace hemi::io
