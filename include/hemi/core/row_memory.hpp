#pragma once

#include <cstddef>
#include <filesystem>
#include <memory_resource>
#include <type_traits>
#include <vector>

namespace hemi {

/// Keeps the rows of form factors that this process makes from now on in a file in `folder`, not in memory.
/// The system keeps as much of it in memory as there is room for, and reads the rest where it is needed. The
/// file has no name: it is gone when the process ends, however that happens. Call it once, before there are
/// rows.
/// @throws InputError if no file can be made there
void keep_rows_in(const std::filesystem::path& folder);

/// Whether keep_rows_in() was called: rows then take no memory that must be counted.
[[nodiscard]] bool rows_are_in_file() noexcept;

/// Where rows are put from now on: in the memory of the process, or in the file. It lives as long as the
/// process, and throws std::bad_alloc or, where there is no room for the file, OutOfMemory.
[[nodiscard]] std::pmr::memory_resource* row_memory() noexcept;

/// Allocator of rows of form factors. Arrays stay where they were made, and take their memory with them when
/// they move.
template <class T>
class RowAllocator {
public:
    using value_type = T;                                          ///< of the arrays
    using propagate_on_container_move_assignment = std::true_type; ///< moved arrays keep their memory
    using propagate_on_container_swap = std::true_type;            ///< likewise

    /// Of row_memory().
    RowAllocator() = default;
    /// The same memory, for arrays of another type.
    template <class Other>
    RowAllocator(const RowAllocator<Other>& other) noexcept // NOLINT(google-explicit-constructor)
        : memory_(other.memory()) {}

    /// Memory for so many values.
    [[nodiscard]] T* allocate(std::size_t count) {
        return static_cast<T*>(memory_->allocate(count * sizeof(T), alignof(T)));
    }
    /// Gives it back.
    void deallocate(T* data, std::size_t count) noexcept {
        memory_->deallocate(data, count * sizeof(T), alignof(T));
    }
    /// Of copies: row_memory().
    [[nodiscard]] RowAllocator select_on_container_copy_construction() const { return {}; }
    /// Where its arrays are.
    [[nodiscard]] std::pmr::memory_resource* memory() const noexcept { return memory_; }
    bool operator==(const RowAllocator& other) const = default; ///< the same memory

private:
    std::pmr::memory_resource* memory_ = row_memory();
};

/// Numbers of the entries of rows.
template <class T>
using RowArray = std::vector<T, RowAllocator<T>>;

} // namespace hemi
