#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/formats/json_node.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mender.hpp"
#include "io/scenes/sides.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

namespace hemi::io {

namespace {

/// Classes of surfaces that have vertices, with the zone that they are of.
constexpr const char* surface_classes[] = {"BuildingSurface:Detailed", "Wall:Detailed",
                                           "RoofCeiling:Detailed", "Floor:Detailed"};
constexpr const char* rectangle_classes[] = {
    "Wall:Exterior",     "Wall:Adiabatic",    "Wall:Underground",    "Wall:Interzone",  "Roof",
    "Ceiling:Adiabatic", "Ceiling:Interzone", "Floor:GroundContact", "Floor:Adiabatic", "Floor:Interzone"};
constexpr const char* opening_classes[] = {"Window",           "Door",           "GlazedDoor",
                                           "Window:Interzone", "Door:Interzone", "GlazedDoor:Interzone"};
/// How far a window may be off its wall, as a share of the wall's longest edge; coordinates are rounded.
constexpr double most_off = 0.01;
constexpr std::size_t most_vertices = 10'000;

/// EnergyPlus' names count in any case.
std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

class EpjsonReader {
public:
    EpjsonReader(const std::filesystem::path& path, const SceneReaderOptions& options,
                 Diagnostics& diagnostics)
        : file_(path.string()), document_(parse_json(read_file(path), file_)), root_(document_, file_),
          options_(options), diagnostics_(diagnostics), mender_(options, "surface") {}

    Scene read() {
        root_.check_object();
        scene_.materials = {{"default", {0.5}, {0.0}}};
        scene_.environment = {0.0};
        choose_zone();
        read_rules();
        for (const char* const name : rectangle_classes) {
            refuse_members(name, "zone_name",
                           [this](const std::string& zone) { return lower(zone) == zone_; });
        }
        for (const char* const name : surface_classes) {
            for_each(name,
                     [this](const JsonNode& surface, const std::string& key) { read_surface(surface, key); });
        }
        if (scene_.surfaces.empty()) {
            throw InputError(fmt::format("{}: zone {} has no surfaces; they are read from {}", file_,
                                         in_quotes(scene_.name), fmt::join(surface_classes, ", ")));
        }
        for (const char* const name : opening_classes) {
            refuse_members(name, "building_surface_name",
                           [this](const std::string& base) { return bases_.contains(lower(base)); });
        }
        for_each("FenestrationSurface:Detailed",
                 [this](const JsonNode& window, const std::string& key) { read_window(window, key); });
        tell_masses();
        mender_.tell(file_, diagnostics_);
        set_sides(scene_, options_, file_, diagnostics_);
        return std::move(scene_);
    }

private:
    /// A surface that windows may lie in.
    struct Base {
        Vec3 centre;
        Vec3 normal; ///< into the zone
        double longest;
    };

    /// Calls `visit(object, name)` for every object of a class.
    template <class Visit>
    void for_each(std::string_view class_name, const Visit& visit) const {
        if (!root_.has(class_name)) {
            return;
        }
        const JsonNode all = root_.member(class_name);
        all.check_object();
        for (const auto& item : all.value().items()) {
            const JsonNode object = all.member(item.key());
            object.check_object();
            visit(object, item.key());
        }
    }

    /// Refuses objects of a class that is not read, where `is_ours` says so of their member `key`.
    template <class IsOurs>
    void refuse_members(std::string_view class_name, const char* key, const IsOurs& is_ours) const {
        for_each(class_name, [&](const JsonNode& object, const std::string&) {
            if (object.has(key) && is_ours(object.member(key).any_text())) {
                object.fail(fmt::format("{} is not supported; write it as {}", class_name,
                                        std::string_view(key) == "zone_name"
                                            ? "BuildingSurface:Detailed"
                                            : "FenestrationSurface:Detailed"));
            }
        });
    }

    void choose_zone() {
        std::vector<std::string> names;
        for_each("Zone", [&](const JsonNode&, const std::string& name) { names.push_back(name); });
        if (names.empty()) {
            throw InputError(fmt::format("{}: no Zone; a scene is a zone of an EnergyPlus model", file_));
        }
        const std::string wanted =
            lower(options_.zone.empty() && names.size() == 1 ? names[0] : options_.zone);
        const auto found = std::find_if(names.begin(), names.end(),
                                        [&](const std::string& name) { return lower(name) == wanted; });
        if (found == names.end() && options_.zone.empty()) {
            throw InvalidArgument(fmt::format("{}: {} zones; one must be chosen (--zone NAME){}", file_,
                                              names.size(), did_you_mean_or_list("", names)));
        }
        if (found == names.end()) {
            throw InvalidArgument(fmt::format("{}: no zone {}{}", file_, in_quotes(options_.zone),
                                              did_you_mean_or_list(options_.zone, names)));
        }
        zone_ = wanted;
        scene_.name = *found;
        const JsonNode zones = root_.member("Zone");
        const JsonNode zone = zones.member(*found);
        const auto number = [&zone](const char* key) {
            return zone.has(key) ? zone.member(key).number() : 0.0;
        };
        origin_ = {number("x_origin"), number("y_origin"), number("z_origin")};
        north_ = glm::radians(number("direction_of_relative_north"));
    }

    void read_rules() {
        bool found = false;
        for_each("GlobalGeometryRules", [&](const JsonNode& rules, const std::string&) {
            found = true;
            const JsonNode direction = rules.member("vertex_entry_direction");
            const std::string way = lower(direction.text());
            if (way != "counterclockwise" && way != "clockwise") {
                direction.expect("Counterclockwise or Clockwise");
            }
            clockwise_ = way == "clockwise";
            const JsonNode system = rules.member("coordinate_system");
            const std::string word = lower(system.text());
            relative_ = word == "relative";
            if (!relative_ && word != "world" && word != "worldcoordinatesystem" && word != "absolute") {
                system.expect("Relative or World");
            }
        });
        if (!found) {
            throw InputError(
                fmt::format("{}: no GlobalGeometryRules, which say how vertices are listed", file_));
        }
    }

    /// Of a surface's vertices; x to the east, y to the north.
    [[nodiscard]] Vec3 placed(const Vec3& point) const {
        if (!relative_) {
            return point;
        }
        const double cosine = std::cos(north_); // north is given clockwise, seen from above
        const double sine = std::sin(north_);
        return origin_ + Vec3(point.x * cosine + point.y * sine, point.y * cosine - point.x * sine, point.z);
    }

    void read_surface(const JsonNode& surface, const std::string& name) {
        const JsonNode zone = surface.member("zone_name");
        if (lower(zone.any_text()) != zone_) {
            return;
        }
        const JsonNode vertices = surface.member("vertices");
        std::vector<Vec3> polygon;
        if (vertices.size() < 3 || vertices.size() > most_vertices) {
            vertices.fail(fmt::format("{} vertices; must be from 3 to {}", vertices.size(), most_vertices));
        }
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            const JsonNode vertex = vertices.element(k);
            polygon.push_back(placed({vertex.member("vertex_x_coordinate").number(),
                                      vertex.member("vertex_y_coordinate").number(),
                                      vertex.member("vertex_z_coordinate").number()}));
        }
        turn_inwards(polygon);
        Base base{Vec3(0.0), Vec3(0.0), 0.0};
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            base.centre += polygon[k] / static_cast<double>(polygon.size());
            base.longest =
                std::max(base.longest, glm::distance(polygon[k], polygon[(k + 1) % polygon.size()]));
        }
        base.normal = area_vector(polygon);
        base.normal = glm::length(base.normal) > 0.0 ? glm::normalize(base.normal) : Vec3(0.0);
        if (!bases_.emplace(lower(name), base).second) {
            surface.fail("another surface has this name, too");
        }
        add(surface, name, polygon);
    }

    /// They are listed as seen from outside the zone.
    void turn_inwards(std::vector<Vec3>& polygon) const {
        if (!clockwise_) {
            std::reverse(polygon.begin(), polygon.end());
        }
    }

    void read_window(const JsonNode& window, const std::string& name) {
        const JsonNode in = window.member("building_surface_name");
        const auto found = bases_.find(lower(in.any_text()));
        if (found == bases_.end()) {
            return; // of another zone
        }
        const Base& base = found->second;
        std::vector<Vec3> polygon;
        for (int k = 1; k <= 4; ++k) {
            const auto coordinate = [&](char axis) {
                return fmt::format("vertex_{}_{}_coordinate", k, axis);
            };
            if (k == 4 && !window.has(coordinate('x'))) {
                break;
            }
            const Vec3 point =
                placed({window.member(coordinate('x')).number(), window.member(coordinate('y')).number(),
                        window.member(coordinate('z')).number()});
            const double off = glm::dot(point - base.centre, base.normal);
            if (std::abs(off) > most_off * base.longest) {
                window.fail(fmt::format("vertex {} is {:.3g} off the plane of {}, which it is in", k,
                                        std::abs(off), in_quotes(in.any_text())));
            }
            polygon.push_back(point - off * base.normal);
        }
        if (glm::dot(area_vector(polygon), base.normal) < 0.0) {
            std::reverse(polygon.begin(), polygon.end());
        }
        if (window.has("multiplier") && window.member("multiplier").number() != 1.0) {
            diagnostics_.warn(fmt::format("{}: {}: the multiplier is not used: the window is there once",
                                          file_, window.path()));
        }
        add(window, name, polygon);
    }

    void add(const JsonNode& place, const std::string& name, std::span<const Vec3> polygon) {
        const auto defect = mender_.mend(polygon, [&] { return FaceSpot{0, place.path()}; });
        if (defect) {
            place.fail(*defect);
        }
        Surface surface;
        surface.group = scene_.group_index(name);
        for (const PolygonPiece& piece : mender_.pieces()) {
            surface.vertices = piece.points;
            surface.vertex_count = piece.count;
            surface.continues = &piece != mender_.pieces().data();
            scene_.surfaces.push_back(surface);
        }
    }

    void tell_masses() {
        std::size_t masses = 0;
        for_each("InternalMass", [&](const JsonNode& mass, const std::string&) {
            for (const char* const key : {"zone_or_zonelist_name", "zone_name"}) {
                masses += mass.has(key) && lower(mass.member(key).any_text()) == zone_ ? 1 : 0;
            }
        });
        if (masses > 0) {
            diagnostics_.warn(
                fmt::format("{}: {} InternalMass left out, which has no place in the zone", file_, masses));
        }
    }

    std::string file_;
    Json document_;
    JsonNode root_;
    const SceneReaderOptions& options_;
    Diagnostics& diagnostics_;
    FaceMender mender_;
    Scene scene_;
    std::string zone_; ///< that is read, in lower case
    Vec3 origin_{0.0};
    double north_ = 0.0; ///< of the zone, clockwise, radians
    bool clockwise_ = false;
    bool relative_ = false;
    std::map<std::string, Base> bases_; ///< by names in lower case
};

} // namespace

Scene read_epjson_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                        Diagnostics& diagnostics) {
    return EpjsonReader(path, options, diagnostics).read();
}

} // namespace hemi::io
