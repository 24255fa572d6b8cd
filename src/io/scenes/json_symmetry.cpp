#include "io/scenes/json_symmetry.hpp"

#include "hemi/core/error.hpp"

#include <string>

namespace hemi::io {

namespace {

constexpr std::uint64_t most_folds = 360;

RotationAxis read_rotation(const JsonNode& node) {
    if (node.size() != 2) {
        node.expect("an axis and a number, as [\"z\", 6]");
    }
    const JsonNode name = node.element(0);
    const std::optional<int> axis = axis_from_text(name.text());
    if (!axis) {
        name.expect("\"x\", \"y\" or \"z\"");
    }
    const JsonNode folds = node.element(1);
    if (folds.integer(most_folds) < 2) {
        folds.expect("2 to 360");
    }
    return {*axis, static_cast<std::uint32_t>(folds.integer(most_folds))};
}

} // namespace

Symmetry read_symmetry(const JsonNode& node) {
    node.check_keys({"mirror", "rotate", "periodic", "images"});
    Symmetry symmetry;
    if (node.has("mirror")) {
        const JsonNode planes = node.member("mirror");
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const JsonNode plane = planes.element(k);
            const std::optional<MirrorPlane> read = plane_from_text(plane.text());
            if (!read) {
                plane.expect("a plane as \"x=0\"");
            }
            symmetry.mirrors.push_back(*read);
        }
    }
    if (node.has("rotate")) {
        symmetry.rotation = read_rotation(node.member("rotate"));
    }
    if (node.has("periodic")) {
        const JsonNode periods = node.member("periodic");
        for (std::size_t k = 0; k < periods.size(); ++k) {
            symmetry.periods.push_back(periods.element(k).point());
        }
    }
    if (node.has("images")) {
        const JsonNode images = node.member("images");
        if (symmetry.periods.empty()) {
            images.fail("images without \"periodic\", the translations that they lie along");
        }
        symmetry.images = images.count();
    }
    return symmetry;
}

Json symmetry_json(const Symmetry& symmetry) {
    Json json = Json::object();
    for (const MirrorPlane& plane : symmetry.mirrors) {
        json["mirror"].push_back(plane_text(plane));
    }
    if (symmetry.rotation) {
        json["rotate"] = Json::array({axis_text(symmetry.rotation->axis), symmetry.rotation->folds});
    }
    for (const Vec3& period : symmetry.periods) {
        json["periodic"].push_back(Json::array({period.x, period.y, period.z}));
    }
    if (!symmetry.periods.empty()) {
        json["images"] = symmetry.images;
    }
    return json;
}

void set_symmetry(Scene& scene, const SymmetryOptions& options) {
    if (options.mirrors.empty() && !options.rotation && options.periods.empty() && !options.images) {
        return;
    }
    Symmetry symmetry = scene.symmetry.value_or(Symmetry());
    if (!options.mirrors.empty()) {
        symmetry.mirrors = options.mirrors;
    }
    if (options.rotation) {
        symmetry.rotation = options.rotation;
    }
    if (!options.periods.empty()) {
        symmetry.periods = options.periods;
    }
    if (options.images && symmetry.periods.empty()) {
        throw InvalidArgument("images without a translation that they lie along", {"periodic"});
    }
    symmetry.images = options.images.value_or(symmetry.images);
    scene.symmetry = std::move(symmetry);
}

} // namespace hemi::io
