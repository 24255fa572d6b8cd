#pragma once

#include <cstdlib> // says whether this is glibc

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace hemi {

/// Gives the system back what was freed: after many pieces the allocator of glibc keeps most of it, and what
/// comes next takes memory of its own.
inline void give_freed_memory_back() noexcept {
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

} // namespace hemi
