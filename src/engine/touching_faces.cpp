#include "hemi/engine/touching_faces.hpp"

#include "engine/rays/ray_tracer.hpp"
#include "hemi/scene/contact.hpp"
#include "hemi/scene/image_mesh.hpp"
#include "scene/surroundings.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

namespace hemi {

namespace {

/// Whether the face that a patch lies against is covered there by the body of the patch: a point just in
/// front of it sees that from inside. Else the two lie back to back, and the patch has its view.
bool is_pressed_on(const RayTracer& tracer, const PatchMesh& mesh, std::uint32_t patch) {
    if (mesh.surfaces()[mesh.surface_of()[patch]].two_sided) {
        return true; // its other side is the one with a view
    }
    const Vec3 normal = mesh.normal(patch);
    const Vec3 eye = mesh.centres()[patch] - 1e-6 * mesh.bounds().diagonal() * normal;
    const std::vector<Vec3> directions = hemisphere(-normal);
    const auto backs = std::count_if(directions.begin(), directions.end(), [&](const Vec3& direction) {
        return tracer.trace(eye, direction).side == RayTracer::Side::back;
    });
    return 2 * static_cast<std::size_t>(backs) >= directions.size();
}

} // namespace

std::vector<std::uint32_t> find_touching_faces(const FormFactorMatrix& factors, const PatchMesh& mesh) {
    constexpr double whole_view = 1.0 - 1e-6; // but for the rounding of shares
    std::vector<std::uint32_t> looking_out;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (factors.known(i) && factors.environment(i) >= whole_view) {
            looking_out.push_back(i);
        }
    }
    std::vector<std::uint32_t> found = patches_in_contact(mesh, looking_out);
    if (!found.empty()) {
        const ImageMesh images(mesh);
        const RayTracer tracer(images.mesh());
        std::erase_if(found, [&](std::uint32_t patch) { return !is_pressed_on(tracer, mesh, patch); });
    }
    return found;
}

void mark_touching_faces_buried(FormFactorMatrix& factors, std::span<const std::uint32_t> contacts,
                                Enclosure enclosure) {
    if (enclosure == Enclosure::open) {
        return;
    }
    if (enclosure == Enclosure::automatic) {
        for (std::uint32_t i = 0; i < factors.size(); ++i) {
            if (factors.known(i) && factors.environment(i) > 0.0 &&
                !std::binary_search(contacts.begin(), contacts.end(), i)) {
                return;
            }
        }
    }
    std::optional<RowBlock> block;
    for (const std::uint32_t patch : contacts) {
        const std::uint32_t index = patch / FormFactorMatrix::block_rows;
        if (block && block->first_row != index * FormFactorMatrix::block_rows) {
            factors.set_block(std::move(*block));
            block.reset();
        }
        if (!block) {
            block = factors.block(index);
        }
        const std::uint32_t local = patch - block->first_row;
        block->blocked[local] += std::exchange(block->environment[local], 0.0);
    }
    if (block) {
        factors.set_block(std::move(*block));
    }
}

} // namespace hemi
