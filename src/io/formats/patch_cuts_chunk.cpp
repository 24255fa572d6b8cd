#include "io/formats/patch_cuts_chunk.hpp"

#include <fmt/format.h>

namespace hemi::io {

std::vector<std::uint32_t> stored_parts(const std::vector<std::vector<GridPart>>& parts) {
    std::vector<std::uint32_t> numbers;
    for (const auto& of_surface : parts) {
        numbers.push_back(static_cast<std::uint32_t>(of_surface.size()));
    }
    for (const auto& of_surface : parts) {
        for (const GridPart& part : of_surface) {
            numbers.insert(numbers.end(), {part.level_u, part.level_v, part.cell});
        }
    }
    return numbers;
}

std::vector<std::vector<GridPart>> read_parts(Payload payload, std::uint64_t surfaces, std::uint64_t most) {
    std::uint64_t all = 0;
    const std::vector<std::uint32_t> counts = payload.take_array<std::uint32_t>(surfaces);
    for (const std::uint32_t count : counts) {
        all += count;
        if (all > most) {
            payload.fail(fmt::format("more parts than the {} patches", most));
        }
    }
    const std::vector<std::uint32_t> numbers = payload.take_array<std::uint32_t>(3 * all);
    payload.expect_end();
    std::vector<std::vector<GridPart>> parts;
    for (const std::uint32_t count : counts) {
        parts.emplace_back(count);
    }
    std::size_t next = 0;
    for (auto& of_surface : parts) {
        for (GridPart& part : of_surface) {
            part = {numbers[next], numbers[next + 1], numbers[next + 2]};
            next += 3;
        }
    }
    return parts;
}

} // namespace hemi::io
