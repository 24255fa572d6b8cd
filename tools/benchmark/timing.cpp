#include "benchmark/timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <ctime>
#include <limits>
#include <utility>

#include <malloc.h>
#include <sys/mman.h>

namespace hemi::bench {

namespace {

constexpr double most_bytes = 4e8;
constexpr double bytes_per_entry = sizeof(std::uint32_t) + sizeof(float);

double clock_seconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Pass {
    double seconds;
    double entries;
};

/// The matrix of `rows`. Its release is not timed: in use it happens once, at the end.
Pass compute(RowProvider& provider, std::span<const std::uint32_t> rows) {
    const auto start = std::chrono::steady_clock::now();
    const FormFactorMatrix matrix = compute_matrix(provider, rows);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    return {elapsed.count(), static_cast<double>(matrix.entries())};
}

double half_distance(const RowView& a, const RowView& b) {
    double sum = std::abs(a.environment - b.environment) + std::abs(a.blocked - b.blocked);
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.columns.size() || j < b.columns.size()) {
        const bool from_a = j == b.columns.size() || (i < a.columns.size() && a.columns[i] <= b.columns[j]);
        const bool from_b = i == a.columns.size() || (j < b.columns.size() && b.columns[j] <= a.columns[i]);
        const double in_a = from_a ? static_cast<double>(a.values[i++]) : 0.0;
        const double in_b = from_b ? static_cast<double>(b.values[j++]) : 0.0;
        sum += std::abs(in_a - in_b);
    }
    return 0.5 * sum;
}

} // namespace

std::vector<Series> time_interleaved(std::span<const Subject> subjects, unsigned rounds) {
    std::vector<Series> series(subjects.size());
    for (unsigned round = 0; round < rounds; ++round) {
        for (std::size_t k = 0; k < subjects.size(); ++k) {
            series[k].push_back(subjects[k]());
        }
    }
    return series;
}

double median(Series series) {
    std::sort(series.begin(), series.end());
    const std::size_t middle = series.size() / 2;
    return series.size() % 2 == 1 ? series[middle] : 0.5 * (series[middle - 1] + series[middle]);
}

double median_ratio(const Series& slow, const Series& fast) {
    Series ratios;
    for (std::size_t k = 0; k < slow.size(); ++k) {
        ratios.push_back(slow[k] / fast[k]);
    }
    return median(std::move(ratios));
}

CoreShare::CoreShare()
    : wall_(clock_seconds(CLOCK_MONOTONIC)), processor_(clock_seconds(CLOCK_PROCESS_CPUTIME_ID)) {}

double CoreShare::so_far() const {
    return (clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - processor_) / (clock_seconds(CLOCK_MONOTONIC) - wall_);
}

void keep_freed_memory() {
    mallopt(M_MMAP_THRESHOLD, std::numeric_limits<int>::max());
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

FreshMemory::FreshMemory() {
    constexpr int default_threshold = 128 * 1024;
    mallopt(M_MMAP_THRESHOLD, default_threshold);
    mallopt(M_TRIM_THRESHOLD, default_threshold);
    malloc_trim(0);
}

double fresh_memory_rate() {
    constexpr std::size_t bytes = std::size_t{1} << 28;
    void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        return 0.0;
    }
    const double start = clock_seconds(CLOCK_MONOTONIC);
    std::memset(memory, 1, bytes);
    const double elapsed = clock_seconds(CLOCK_MONOTONIC) - start;
    munmap(memory, bytes);
    return static_cast<double>(bytes) / elapsed;
}

Subject row_subject(RowProvider& provider, std::vector<std::uint32_t> rows, double seconds) {
    return [&provider, rows = std::move(rows), seconds] {
        double elapsed = 0.0;
        double done = 0.0;
        while (elapsed < seconds) {
            elapsed += compute(provider, rows).seconds;
            done += static_cast<double>(rows.size());
        }
        return elapsed / done;
    };
}

std::uint32_t rows_within(RowProvider& provider, double seconds, std::uint32_t least) {
    const std::uint32_t size = provider.size();
    static_cast<void>(compute(provider, spread_rows(size, 1, 1)));
    std::uint32_t rows = 4;
    for (;;) {
        const auto sample = spread_rows(size, rows, 1);
        const Pass pass = compute(provider, sample);
        const auto computed = static_cast<double>(sample.size());
        if (pass.seconds >= 0.1 * seconds || sample.size() == size) {
            const double bytes_per_row = std::max(1.0, bytes_per_entry * pass.entries / computed);
            const double in_time = std::max(computed * seconds / pass.seconds, static_cast<double>(least));
            const double wanted = std::min(in_time, most_bytes / bytes_per_row);
            return static_cast<std::uint32_t>(std::clamp(wanted, 1.0, static_cast<double>(size)));
        }
        rows *= 2;
    }
}

std::vector<std::uint32_t> spread_rows(std::uint32_t size, std::uint32_t rows, std::uint32_t together) {
    const std::uint64_t runs_there = (std::uint64_t{size} + together - 1) / together;
    const std::uint64_t runs =
        std::clamp((std::uint64_t{rows} + together - 1) / together, std::uint64_t{1}, runs_there);
    std::vector<std::uint32_t> spread;
    for (std::uint64_t k = 0; k < runs; ++k) {
        const std::uint64_t first = (2 * k + 1) * runs_there / (2 * runs) * together;
        for (std::uint64_t row = first; row < std::min<std::uint64_t>(first + together, size); ++row) {
            spread.push_back(static_cast<std::uint32_t>(row));
        }
    }
    return spread;
}

double row_difference(RowProvider& a, RowProvider& b, std::span<const std::uint32_t> rows) {
    const FormFactorMatrix from_a = compute_matrix(a, rows);
    const FormFactorMatrix from_b = compute_matrix(b, rows);
    double squares = 0.0;
    for (const std::uint32_t row : rows) {
        const double distance = half_distance(from_a.row(row), from_b.row(row));
        squares += distance * distance;
    }
    return std::sqrt(squares / static_cast<double>(rows.size()));
}

} // namespace hemi::bench
