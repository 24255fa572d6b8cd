#include "viewer/bookmarks.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

namespace hemi::viewer {

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* schema = "hemi/cameras/1";

Vec3 to_point(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Camera to_camera(const Json& json) {
    Camera camera;
    camera.eye = to_point(json.at("eye"));
    camera.target = to_point(json.at("target"));
    camera.up = to_point(json.at("up"));
    camera.fov = json.at("fov").get<double>();
    camera.orthographic = json.at("orthographic").get<bool>();
    return camera;
}

bool is_usable(const Camera& camera) {
    const Vec3 view = camera.target - camera.eye;
    return glm::length(glm::cross(view, camera.up)) > 1e-9 * glm::length(view) * glm::length(camera.up) &&
           camera.fov > 0.0 && camera.fov < 180.0;
}

Json point(const Vec3& p) {
    return {p.x, p.y, p.z};
}

} // namespace

Bookmarks::Bookmarks(const std::filesystem::path& scene)
    : file_(scene.string() + ".cameras"), cameras_(read(file_)) {}

Bookmarks::Cameras Bookmarks::read(const std::filesystem::path& file) {
    Cameras cameras;
    std::error_code unknown; // a name that no file can have
    if (!std::filesystem::exists(file, unknown)) {
        return cameras;
    }
    const auto refuse = [&file](const std::string& what) {
        throw InputError(
            fmt::format("{}: {}; must be cameras as the window keeps them", file.string(), what));
    };
    const std::string text = io::read_file(file);
    try {
        const Json json = Json::parse(text);
        if (json.at("schema") != schema) {
            refuse(fmt::format("schema {}", json.at("schema").dump()));
        }
        for (int number = 1; number <= count; ++number) {
            const std::string name = std::to_string(number);
            if (json.at("cameras").contains(name)) {
                const Camera camera = to_camera(json.at("cameras").at(name));
                if (!is_usable(camera)) {
                    refuse(fmt::format("camera {} has no direction, or no field of view", number));
                }
                cameras[static_cast<std::size_t>(number - 1)] = camera;
            }
        }
    } catch (const Json::exception& error) {
        refuse(error.what());
    }
    return cameras;
}

void Bookmarks::store(int number, const Camera& camera) {
    if (file_.empty()) {
        throw IoError("no camera can be kept: the file of those beside the scene is not one of cameras");
    }
    Cameras cameras = read(file_); // another window may have kept one
    cameras[static_cast<std::size_t>(number - 1)] = camera;
    Json json{{"schema", schema}, {"cameras", Json::object()}};
    for (std::size_t k = 0; k < cameras.size(); ++k) {
        if (const std::optional<Camera>& kept = cameras[k]) {
            json["cameras"][std::to_string(k + 1)] = {{"eye", point(kept->eye)},
                                                      {"target", point(kept->target)},
                                                      {"up", point(kept->up)},
                                                      {"fov", kept->fov},
                                                      {"orthographic", kept->orthographic}};
        }
    }
    io::OutputFile file(file_);
    file.write(json.dump(1) + "\n");
    file.commit();
    cameras_ = cameras;
}

} // namespace hemi::viewer
