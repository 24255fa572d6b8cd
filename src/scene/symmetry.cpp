#include "hemi/scene/symmetry.hpp"

#include "hemi/core/error.hpp"
#include "hemi/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

namespace {

constexpr char axis_names[] = "xyz";
/// Images that differ by less, relative to 1 and to the longest shift, are the same one.
constexpr double same = 1e-9;
/// Of the scene's diagonal: as far beyond a mirror plane may corners be that files have in single precision.
constexpr double beyond = 1e-6;
/// Directions of the sun that differ by less, radians, are the same one: far less than its own size.
constexpr double sunlight = 1e-6;
/// In diagonals of the scene: at that distance double precision still holds nine digits of it.
constexpr double farthest_image = 1e6;

Isometry operator*(const Isometry& after, const Isometry& before) {
    return {after.turn * before.turn, after(before.shift)};
}

Isometry inverse_of(const Isometry& image) {
    const glm::dmat3 back = glm::transpose(image.turn);
    return {back, -(back * image.shift)};
}

/// Images without two that are alike.
class ImageSet {
public:
    /// @param scale  of shifts
    explicit ImageSet(double scale) : scale_(scale) { all.push_back({}); }

    [[nodiscard]] std::size_t find(const Isometry& image) const {
        const auto found = std::find_if(all.begin(), all.end(), [&](const Isometry& one) {
            double difference = 0.0;
            for (int column = 0; column < 3; ++column) {
                difference = std::max(difference, glm::length(one.turn[column] - image.turn[column]));
            }
            return difference <= same && glm::length(one.shift - image.shift) <= same * scale_;
        });
        return static_cast<std::size_t>(found - all.begin());
    }
    /// @return whether it was not there
    bool add(const Isometry& image) {
        if (find(image) < all.size()) {
            return false;
        }
        all.push_back(image);
        return true;
    }

    std::vector<Isometry> all;

private:
    double scale_;
};

Isometry mirror_image(const MirrorPlane& plane) {
    Isometry image;
    image.turn[plane.axis][plane.axis] = -1.0;
    image.shift[plane.axis] = 2.0 * plane.offset;
    return image;
}

/// A turn by `k` of `folds`; quarter turns are exact.
Isometry turned(const RotationAxis& rotation, std::uint32_t k) {
    double cosine = std::cos(2.0 * std::numbers::pi * k / rotation.folds);
    double sine = std::sin(2.0 * std::numbers::pi * k / rotation.folds);
    if (4 * k % rotation.folds == 0) {
        cosine = std::round(cosine);
        sine = std::round(sine);
    }
    const int u = (rotation.axis + 1) % 3;
    const int v = (rotation.axis + 2) % 3;
    Isometry image;
    image.turn[u][u] = cosine;
    image.turn[u][v] = sine;
    image.turn[v][u] = -sine;
    image.turn[v][v] = cosine;
    return image;
}

void check_values(const Symmetry& symmetry) {
    if (symmetry.mirrors.empty() && !symmetry.rotation && symmetry.periods.empty()) {
        throw InputError("symmetry: neither mirror plane nor rotation nor translation");
    }
    for (std::size_t k = 0; k < symmetry.mirrors.size(); ++k) {
        const MirrorPlane& plane = symmetry.mirrors[k];
        if (plane.axis < 0 || plane.axis > 2 || !std::isfinite(plane.offset)) {
            throw InputError(fmt::format("symmetry: mirror plane {} = {}; must be across an axis, and finite",
                                         plane.axis, plane.offset));
        }
        for (std::size_t other = 0; other < k; ++other) {
            if (symmetry.mirrors[other].axis == plane.axis) {
                throw InputError(fmt::format("symmetry: the mirror planes {} and {} are not perpendicular",
                                             plane_text(symmetry.mirrors[other]), plane_text(plane)));
            }
        }
    }
    if (symmetry.rotation && (symmetry.rotation->axis < 0 || symmetry.rotation->axis > 2 ||
                              symmetry.rotation->folds < 2 || symmetry.rotation->folds > 360)) {
        throw InputError(
            fmt::format("symmetry: a rotation of {} folds; must be 2 to 360", symmetry.rotation->folds));
    }
}

/// Twice the area of two translations, or six times the volume of three, relative to their lengths.
double independence(std::span<const Vec3> periods) {
    if (periods.size() == 1) {
        return 1.0;
    }
    const Vec3 across = glm::cross(glm::normalize(periods[0]), glm::normalize(periods[1]));
    return periods.size() == 2 ? glm::length(across) : std::abs(glm::dot(across, glm::normalize(periods[2])));
}

std::string vector_text(const Vec3& vector) {
    return fmt::format("({}, {}, {})", vector.x, vector.y, vector.z);
}

void check_periods(const Symmetry& symmetry, std::span<const Isometry> others) {
    if (symmetry.periods.empty()) {
        return;
    }
    if (symmetry.images == 0) {
        throw InputError("symmetry: 0 images along a translation; must be at least 1");
    }
    for (const Vec3& period : symmetry.periods) {
        if (!(glm::length(period) > 0.0) || !std::isfinite(glm::length(period))) {
            throw InputError(
                fmt::format("symmetry: a translation by {}; must be finite and not 0", vector_text(period)));
        }
    }
    if (symmetry.periods.size() > 3 || !(independence(symmetry.periods) > same)) {
        throw InputError("symmetry: a translation that follows from the others; must be three at most, in "
                         "different directions and not in one plane");
    }
    for (const Isometry& image : others) {
        for (const Vec3& period : symmetry.periods) {
            const Vec3 there = image.direction(period);
            const auto is_same = [&](const Vec3& one) {
                const double most = same * glm::length(period);
                return glm::length(one - there) <= most || glm::length(one + there) <= most;
            };
            if (std::none_of(symmetry.periods.begin(), symmetry.periods.end(), is_same)) {
                throw InputError(fmt::format("symmetry: a mirror plane or rotation makes the translation {} "
                                             "another one, {}",
                                             vector_text(period), vector_text(there)));
            }
        }
    }
}

/// Translations, the one by nothing first.
std::vector<Vec3> translations(const Symmetry& symmetry) {
    std::vector<Vec3> all{Vec3(0.0)};
    for (const Vec3& period : symmetry.periods) {
        const std::vector<Vec3> before = all;
        for (std::uint32_t k = 1; k <= symmetry.images; ++k) {
            if (all.size() + 2 * before.size() > most_images) {
                throw InputError(fmt::format("symmetry: {} images along {} give more than {} in all",
                                             symmetry.images, vector_text(period), most_images));
            }
            for (const double times : {static_cast<double>(k), -static_cast<double>(k)}) {
                for (const Vec3& one : before) {
                    all.push_back(one + times * period);
                }
            }
        }
    }
    return all;
}

} // namespace

std::string plane_text(const MirrorPlane& plane) {
    return fmt::format("{}={}", axis_text(plane.axis), plane.offset);
}

std::optional<MirrorPlane> plane_from_text(std::string_view text) {
    const std::size_t sign = text.find('=');
    if (sign == std::string_view::npos) {
        return std::nullopt;
    }
    const std::optional<int> axis = axis_from_text(text.substr(0, sign));
    const std::string_view number = text.substr(sign + 1);
    double offset = 0.0;
    const auto [end, problem] = std::from_chars(number.data(), number.data() + number.size(), offset);
    if (!axis || problem != std::errc{} || end != number.data() + number.size() || !std::isfinite(offset)) {
        return std::nullopt;
    }
    return MirrorPlane{*axis, offset + 0.0}; // +0.0: -0 and 0 are the same plane
}

std::string axis_text(int axis) {
    return {axis_names[static_cast<std::size_t>(axis)]};
}

std::optional<int> axis_from_text(std::string_view text) {
    const std::size_t axis = std::string_view(axis_names).find(text);
    return text.size() == 1 && axis < 3 ? std::optional(static_cast<int>(axis)) : std::nullopt;
}

SceneImages images_of(const Symmetry& symmetry) {
    check_values(symmetry);
    double scale = 0.0;
    std::vector<Isometry> generators;
    for (const MirrorPlane& plane : symmetry.mirrors) {
        generators.push_back(mirror_image(plane));
        scale = std::max(scale, std::abs(plane.offset));
    }
    for (const Vec3& period : symmetry.periods) {
        scale = std::max(scale, glm::length(period));
    }
    ImageSet points(scale);
    if (symmetry.rotation) {
        for (std::uint32_t k = 1; k < symmetry.rotation->folds; ++k) {
            points.all.push_back(turned(*symmetry.rotation, k));
        }
        generators.push_back(points.all[1]);
    }
    for (std::size_t k = 0; k < points.all.size(); ++k) {
        for (const Isometry& generator : generators) {
            const Isometry image = points.all[k] * generator;
            if (points.add(image) && points.all.size() > most_images) {
                throw InputError(
                    "symmetry: mirror planes and rotation give images without end; a mirror plane "
                    "must hold the axis of rotation or be across it");
            }
        }
    }
    check_periods(symmetry, points.all);
    const std::vector<Vec3> shifts = translations(symmetry);
    if (shifts.size() * points.all.size() > most_images) {
        throw InputError(fmt::format("symmetry: {} images; must be {} at most",
                                     shifts.size() * points.all.size(), most_images));
    }
    ImageSet images(scale);
    images.all.clear();
    for (const Vec3& shift : shifts) {
        for (const Isometry& image : points.all) {
            images.all.push_back({image.turn, image.shift + shift});
        }
    }
    SceneImages result;
    for (const Isometry& image : images.all) {
        const std::size_t back = images.find(inverse_of(image));
        if (back == images.all.size()) { // not by what was checked
            throw Error("symmetry: an image without its opposite");
        }
        result.inverse.push_back(static_cast<std::uint32_t>(back));
    }
    result.all = std::move(images.all);
    return result;
}

void check_symmetry(const Scene& scene) {
    if (!scene.symmetry) {
        return;
    }
    const SceneImages images = images_of(*scene.symmetry);
    if (scene.sky) {
        throw InputError("symmetry: the scene has a sky, of which images hide parts that are not known here; "
                         "leave one out, or give the environment an exitance");
    }
    for (const Isometry& image : images.all) {
        const Vec3 there = scene.sun ? image.direction(scene.sun->direction) : Vec3(0.0);
        if (scene.sun && glm::length(there - scene.sun->direction) > sunlight) {
            throw InputError(
                fmt::format("symmetry: the sun stands towards {}, in an image of the scene towards "
                            "{}; must be the same in all images",
                            vector_text(scene.sun->direction), vector_text(there)));
        }
    }
    const double across = scene.bounds().diagonal();
    for (const Isometry& image : images.all) {
        const double away = glm::length(image(scene.bounds().centre()) - scene.bounds().centre());
        if (!(away <= farthest_image * across)) {
            throw InputError(
                fmt::format("symmetry: an image is {:.3g} away from the scene, which is {:.3g} across; "
                            "must be at most {:g} times as far",
                            away, across, farthest_image));
        }
    }
    const double tolerance = beyond * across;
    const auto face = [&scene](std::size_t s) {
        return fmt::format("face {} (group \"{}\")", face_numbers(scene.surfaces)[s],
                           scene.groups[scene.surfaces[s].group]);
    };
    for (const MirrorPlane& plane : scene.symmetry->mirrors) {
        std::array<double, 2> farthest{};     // on either side
        std::array<std::size_t, 2> surface{}; // that is there
        for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
            double off = 0.0;
            for (const Vec3& corner : scene.surfaces[s].polygon()) {
                const double height = corner[plane.axis] - plane.offset;
                const std::size_t side = height < 0.0 ? 0 : 1;
                off = std::max(off, std::abs(height));
                if (std::abs(height) > farthest[side]) {
                    farthest[side] = std::abs(height);
                    surface[side] = s;
                }
            }
            if (off <= tolerance) {
                throw InputError(
                    fmt::format("{} lies in the mirror plane {}, where the scene meets its image; "
                                "leave it out",
                                face(s), plane_text(plane)));
            }
        }
        const std::size_t wrong = farthest[0] < farthest[1] ? 0 : 1;
        if (farthest[wrong] > tolerance) {
            throw InputError(
                fmt::format("{} reaches {:.6g} beyond the mirror plane {}; what is given must lie "
                            "on one side of it",
                            face(surface[wrong]), farthest[wrong], plane_text(plane)));
        }
    }
}

} // namespace hemi
