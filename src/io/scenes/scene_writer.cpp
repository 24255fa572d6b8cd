#include "hemi/io/scene_writer.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/formats/json_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
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

/// First and one after the last byte of a value.
using Place = std::pair<std::size_t, std::size_t>;

/// A member's value in an object of a sound JSON text.
/// @param object  where that begins
std::optional<Place> find_member(std::string_view text, std::size_t object, std::string_view key) {
    std::size_t at = object + 1;
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
            return Place(first, end);
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

std::string values_text(std::span<const double> values) {
    // Equal ones, too, each by itself: a scene that names no channels has as many as its lists are long.
    return values.size() == 1 ? fmt::format("{}", values.front())
                              : fmt::format("[{}]", fmt::join(values, ", "));
}

/// Puts a member into an object, in place of one of that name or behind all else.
/// @param object  where it begins
/// @param before  between the last member and a new one
void put_member(std::string& text, std::size_t object, std::string_view key, const std::string& value,
                std::string_view before) {
    if (const auto found = find_member(text, object, key)) {
        text.replace(found->first, found->second - found->first, value);
        return;
    }
    const std::size_t end = after_value(text, object); // one after its brace
    const std::size_t last = text.find_last_not_of(blanks, end - 2);
    const bool empty = last == object;
    text.insert(last + 1, fmt::format("{}\"{}\": {}", empty ? "" : before, key, value));
}

/// @param what  it takes
std::string read_scene(const std::filesystem::path& path, std::string_view what) {
    if (path.extension() != ".json") {
        throw InvalidArgument(fmt::format("{}: only a JSON scene takes {}", path.string(), what));
    }
    std::string text = read_file(path);
    const Json scene = parse_json(text, path.string());
    if (!scene.is_object() || scene.empty()) {
        throw InputError(fmt::format("{}: not a scene", path.string()));
    }
    return text;
}

void write(const std::filesystem::path& path, std::string_view text) {
    OutputFile file(path);
    file.write(text);
    file.commit();
}

/// Reads a text as the scene that it would be.
/// @throws InvalidArgument where it would be none
void try_scene(const std::filesystem::path& path, std::string_view text) {
    const std::filesystem::path tried =
        path.parent_path() / fmt::format(".{}.tried.json", path.stem().string()); // meshes are beside it
    struct Removed {
        const std::filesystem::path& file;
        ~Removed() {
            std::error_code ignored;
            std::filesystem::remove(file, ignored);
        }
    } const removed{tried};
    write(tried, text);
    SceneReaderOptions options;
    options.allow_outside = true;
    options.adiabatic = true;
    Diagnostics ignored;
    try {
        (void)read_json_scene(tried, options, ignored);
    } catch (const InputError& error) {
        std::string why = error.what();
        why.erase(0, why.starts_with(tried.string()) ? tried.string().size() + 2 : 0);
        throw InvalidArgument(
            fmt::format("{}: not written, since it could not be read any more: {}", path.string(), why));
    }
}

} // namespace

void write_scene_camera(const std::filesystem::path& path, const Camera& camera) {
    std::string text = read_scene(path, "a camera");
    put_member(text, text.find('{'), "camera", camera_text(camera), ",\n  ");
    write(path, text);
}

void write_scene_materials(const std::filesystem::path& path, std::span<const MaterialValues> materials,
                           std::span<const double> environment) {
    std::string text = read_scene(path, "materials");
    const std::size_t scene = text.find('{');
    for (const MaterialValues& material : materials) {
        const auto object_of = [&] { // moves while members are put
            const auto all = find_member(text, scene, "materials");
            return all && text[all->first] == '{' ? find_member(text, all->first, material.name)
                                                  : std::nullopt;
        };
        const auto found = object_of();
        if (!found || text[found->first] != '{') {
            throw InvalidArgument(fmt::format(
                "{}: no material \"{}\"; it is not one of the file's own, so save the result instead",
                path.string(), material.name));
        }
        if (!material.reflectance.empty() && find_member(text, found->first, "emissivity")) {
            throw InvalidArgument(fmt::format("{}: materials.{}: has an emissivity, from which its "
                                              "reflectance follows; change that in the file",
                                              path.string(), material.name));
        }
        if (!material.reflectance.empty()) {
            put_member(text, object_of()->first, "reflectance", values_text(material.reflectance), ", ");
        }
        if (!material.exitance.empty()) {
            put_member(text, object_of()->first, "exitance", values_text(material.exitance), ", ");
        }
    }
    if (!environment.empty()) {
        const auto found = find_member(text, scene, "environment");
        if (found && text[found->first] == '{') {
            put_member(text, found->first, "exitance", values_text(environment), ", ");
        } else {
            put_member(text, scene, "environment",
                       fmt::format(R"({{"exitance": {}}})", values_text(environment)), ",\n  ");
        }
    }
    try_scene(path, text);
    write(path, text);
}

} // namespace hemi::io
