#include "hemi/engine/touching_faces.hpp"

#include "hemi/scene/contact.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace hemi {

std::vector<std::uint32_t> find_touching_faces(const FormFactorMatrix& factors, const PatchMesh& mesh) {
    constexpr double whole_view = 1.0 - 1e-6; // but for the rounding of shares
    std::vector<std::uint32_t> looking_out;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (factors.known(i) && factors.row(i).environment >= whole_view) {
            looking_out.push_back(i);
        }
    }
    return patches_in_contact(mesh, looking_out);
}

void mark_touching_faces_buried(FormFactorMatrix& factors, std::span<const std::uint32_t> contacts,
                                Enclosure enclosure) {
    if (enclosure == Enclosure::open) {
        return;
    }
    if (enclosure == Enclosure::automatic) {
        for (std::uint32_t i = 0; i < factors.size(); ++i) {
            if (factors.known(i) && factors.row(i).environment > 0.0 &&
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
            block = factors.blocks()[index];
        }
        const std::uint32_t local = patch - block->first_row;
        block->blocked[local] += std::exchange(block->environment[local], 0.0);
    }
    if (block) {
        factors.set_block(std::move(*block));
    }
}

} // namespace hemi
