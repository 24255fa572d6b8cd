#include "core/huge_pages.hpp"

#include <cstdint>

#include <sys/mman.h>

namespace hemi {

void prefer_huge_pages(void* memory, std::size_t bytes) noexcept {
    constexpr std::uintptr_t page = std::uintptr_t{1} << 21;
    const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + page - 1) / page * page;
    const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / page * page;
    if (begin < end) {
        madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
    }
}

} // namespace hemi
