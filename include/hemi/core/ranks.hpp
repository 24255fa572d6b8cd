#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Processes that work on one result together, on one machine or on many: all run the same program with the
/// same arguments, each does its share of what takes long, and all get what the others found. Calls must be
/// made by all ranks, in the same order, from the thread that started the program.
class Ranks {
public:
    virtual ~Ranks() = default;

    /// Which of them this process is, from 0.
    [[nodiscard]] virtual std::uint32_t rank() const noexcept = 0;
    /// How many there are.
    [[nodiscard]] virtual std::uint32_t size() const noexcept = 0;
    /// How many are on this machine, and share its memory and processors.
    [[nodiscard]] virtual std::uint32_t on_machine() const noexcept = 0;

    /// Gives all ranks what every one of them has.
    /// @param own  bytes of this rank, of any number
    /// @return those of all ranks, in their order
    [[nodiscard]] virtual std::vector<std::vector<std::byte>> gather(std::span<const std::byte> own) = 0;

    /// Waits some seconds for all others to come here, which they do when they end or fail.
    /// @return whether they are here; else they still count on this rank
    [[nodiscard]] virtual bool meet() noexcept = 0;
};

/// The ranks that this process is one of: what set_ranks() installed, else this process alone.
[[nodiscard]] Ranks& ranks() noexcept;

/// Installs the ranks for the whole process.
/// @param ranks  must outlive all work; null: the process is alone
void set_ranks(Ranks* ranks) noexcept;

/// Where the share of a rank begins, of things that all ranks share in equal parts, one behind the other.
/// @param ranks  who shares them
/// @param rank   whose share; the number of ranks: the end of the last one's
/// @param count  of the things
[[nodiscard]] inline std::size_t begin_of_share(const Ranks& ranks, std::uint32_t rank, std::size_t count) {
    return count * rank / ranks.size();
}

/// Gathers values that are copied as they lie in memory, one after the other.
/// @param ranks  who takes part
/// @param own    values of this rank, of any number
/// @return those of all ranks, in their order
template <class T>
[[nodiscard]] std::vector<T> gather_values(Ranks& ranks, std::span<const T> own) {
    std::vector<T> all;
    for (const std::vector<std::byte>& bytes : ranks.gather(std::as_bytes(own))) {
        const T* const values = reinterpret_cast<const T*>(bytes.data());
        all.insert(all.end(), values, values + bytes.size() / sizeof(T));
    }
    return all;
}

} // namespace hemi
