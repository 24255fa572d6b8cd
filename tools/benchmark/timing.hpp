#pragma once

#include "hemi/engine/row_provider.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hemi::bench {

/// How long to measure.
struct Effort {
    double seconds; ///< of one run, at least
    unsigned rounds;
};

/// Something to be timed: each call is one run, and tells the seconds a unit took.
using Subject = std::function<double()>;
/// The runs of one subject, in order.
using Series = std::vector<double>;

/// Runs all subjects in turn, `rounds` times, so that what disturbs the machine meets all alike.
[[nodiscard]] std::vector<Series> time_interleaved(std::span<const Subject> subjects, unsigned rounds);

[[nodiscard]] double median(Series series);
/// Median over the rounds of `slow` / `fast`.
[[nodiscard]] double median_ratio(const Series& slow, const Series& fast);

/// How much of one core this process has had since a moment: 1 where nothing else wanted it. Of use while a
/// single thread computes.
class CoreShare {
public:
    CoreShare();
    [[nodiscard]] double so_far() const;

private:
    double wall_;
    double processor_;
};

/// From now on memory that is given back stays with the process: matrices of further runs lie in pages that
/// were touched before.
void keep_freed_memory();

/// While it lives, memory that is given back goes to the system, and every matrix waits for it to clear fresh
/// pages, as the first matrix of a program does. How long that takes is a property of the machine.
class FreshMemory {
public:
    FreshMemory();
    ~FreshMemory() { keep_freed_memory(); }
    FreshMemory(const FreshMemory&) = delete;
    FreshMemory& operator=(const FreshMemory&) = delete;
};

/// Bytes per second at which memory that was never touched is written, page by page.
[[nodiscard]] double fresh_memory_rate();

/// Seconds a row: computes the rows as a matrix, again and again until `seconds` have passed.
/// @param provider  must outlive the subject.
[[nodiscard]] Subject row_subject(RowProvider& provider, std::vector<std::uint32_t> rows, double seconds);

/// About how many rows `provider` computes in `seconds`, but `least`; at most all, and no more than fit into
/// a few hundred megabytes as a matrix. Starts its contexts and workers.
[[nodiscard]] std::uint32_t rows_within(RowProvider& provider, double seconds, std::uint32_t least = 1);

/// About `rows` rows: runs of `together` neighbours, spread evenly over `size` patches.
[[nodiscard]] std::vector<std::uint32_t> spread_rows(std::uint32_t size, std::uint32_t rows,
                                                     std::uint32_t together);

/// Share of a row that two providers give to different patches: half the sum of |a - b| over patches,
/// environment and blocked; root mean square over `rows`.
[[nodiscard]] double row_difference(RowProvider& a, RowProvider& b, std::span<const std::uint32_t> rows);

} // namespace hemi::bench
