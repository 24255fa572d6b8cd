#include "hemi/scene/contact.hpp"

#include "core/box_tree.hpp"
#include "core/parallel_for.hpp"
#include "scene/convex_polygon.hpp"
#include "scene/joined_faces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hemi {

namespace {

constexpr double near_share = 1e-4;  ///< of the scene's diagonal
constexpr double least_length = 100; ///< of an edge, in gaps
constexpr double most_parallel = 0.9;

/// The largest distance of an edge from the plane of a face that it ends above.
std::optional<double> gap_between(const Vec3& from, const Vec3& to, std::span<const Vec3> face,
                                  const Vec3& normal, double touching) {
    const double first = glm::dot(from - face[0], normal);
    const double last = glm::dot(to - face[0], normal);
    const double gap = std::max(std::abs(first), std::abs(last));
    const bool beside = std::min(std::abs(first), std::abs(last)) > touching && first * last > 0.0;
    const bool over = beside && least_length * gap <= glm::distance(from, to) &&
                      contains(face, normal, 0.5 * (from + to), 0.0);
    return over ? std::optional(gap) : std::nullopt;
}

} // namespace

std::vector<NearContact> near_contacts(const Scene& scene) {
    const std::vector<Surface>& surfaces = scene.surfaces;
    if (std::none_of(surfaces.begin(), surfaces.end(), [](const Surface& one) { return one.two_sided; })) {
        return {};
    }
    std::vector<Bounds> boxes;
    std::vector<Vec3> normals;
    for (const Surface& surface : surfaces) {
        boxes.push_back(bounds_of(surface.polygon()));
        normals.push_back(glm::normalize(area_vector(surface.polygon())));
    }
    const BoxTree tree(boxes);
    const double diagonal = scene.bounds().diagonal();
    std::vector<std::vector<NearContact>> found(surfaces.size());
    const auto look = [&](std::uint32_t sheet) {
        const std::span<const Vec3> corners = surfaces[sheet].polygon();
        std::vector<std::uint32_t> others;
        tree.overlapping(bounds_of(corners, near_share * diagonal), [&](std::uint32_t other) {
            if (other != sheet && std::abs(glm::dot(normals[other], normals[sheet])) < most_parallel) {
                others.push_back(other);
            }
        });
        std::sort(others.begin(), others.end());
        for (const std::uint32_t other : others) {
            for (std::size_t k = 0; k < corners.size(); ++k) {
                const auto gap =
                    gap_between(corners[k], corners[(k + 1) % corners.size()], surfaces[other].polygon(),
                                normals[other], contact_share * diagonal);
                if (gap && *gap <= near_share * diagonal) {
                    found[sheet].push_back({sheet, other, *gap});
                    break;
                }
            }
        }
    };
    parallel_for(surfaces.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t sheet = begin; sheet < end; ++sheet) {
            if (surfaces[sheet].two_sided) {
                look(static_cast<std::uint32_t>(sheet));
            }
        }
    });
    std::vector<NearContact> result;
    for (const std::vector<NearContact>& of_sheet : found) {
        result.insert(result.end(), of_sheet.begin(), of_sheet.end());
    }
    return result;
}

std::vector<std::uint32_t> patches_in_contact(const PatchMesh& mesh, std::span<const std::uint32_t> patches) {
    std::vector<std::uint32_t> found;
    const double slack = 1e-7 * mesh.bounds().diagonal();
    for (const std::uint32_t patch : patches) {
        const Vec3 normal = mesh.normal(patch);
        const Vec3& centre = mesh.centres()[patch];
        for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
            const auto polygon = mesh.surfaces()[s].polygon();
            if (s != mesh.surface_of()[patch] && glm::dot(mesh.surface_normal(s), normal) < -1.0 + 1e-6 &&
                std::abs(glm::dot(centre - polygon[0], normal)) <= slack &&
                contains(polygon, mesh.surface_normal(s), centre, slack)) {
                found.push_back(patch);
                break;
            }
        }
    }
    return found;
}

} // namespace hemi
