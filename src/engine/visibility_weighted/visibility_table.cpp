#include "engine/visibility_weighted/visibility_table.hpp"

#include "engine/visibility_weighted/coplanar_neighbours.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hemi {

namespace {

/// Patches of whose samples a rank needs those of every row: its own, and what may stand in for them.
struct Columns {
    OwnRows::Part first;
    OwnRows::Part second;

    explicit Columns(const VisibilityTable& table)
        : first(around(table, table.own.first())), second(around(table, table.own.second())) {
        if (second.first < first.end) { // side by side in the middle
            first.end = std::max(first.end, second.end);
            second = {};
        }
    }

private:
    static OwnRows::Part around(const VisibilityTable& table, const OwnRows::Part& rows) {
        if (rows.first == rows.end) {
            return {};
        }
        const std::span<const std::uint32_t> patches = table.index.patches();
        constexpr std::uint32_t reach = CoplanarNeighbours::reach;
        const std::uint32_t lowest = patches[rows.first];
        return {lowest - std::min(lowest, reach),
                std::min(table.index.size(), patches[rows.end - 1] + reach + 1)};
    }
};

/// The row's samples of some patches that follow each other, added to `samples`.
void add_samples(const VisibilityRow& row, const OwnRows::Part& columns,
                 std::vector<VisibilitySample>& samples) {
    const std::size_t before = samples.size();
    samples.resize(before + columns.end - columns.first);
    const auto lowest = std::lower_bound(row.columns.begin(), row.columns.end(), columns.first);
    for (auto entry = static_cast<std::size_t>(lowest - row.columns.begin());
         entry < row.columns.size() && row.columns[entry] < columns.end; ++entry) {
        samples[before + row.columns[entry] - columns.first] = {row.shares[entry], row.texels[entry]};
    }
}

/// Values of which every rank knows its own, and has 0 elsewhere.
std::vector<double> joined(const std::vector<double>& own) {
    const std::vector<double> all = gather_values(ranks(), std::span<const double>(own));
    std::vector<double> result(own.size(), 0.0);
    for (std::size_t k = 0; k < all.size(); ++k) {
        result[k % own.size()] += all[k];
    }
    return result;
}

} // namespace

VisibilityTable sample_visibility(VisibilityProvider& visibility, std::span<const std::uint32_t> patches,
                                  std::uint32_t size, bool divided, const Progress& progress) {
    const auto count = static_cast<std::uint32_t>(patches.size());
    VisibilityTable table{RowIndex(patches, size),
                          divided ? OwnRows(count, ranks().rank(), ranks().size()) : OwnRows(count),
                          {},
                          {},
                          {},
                          {}};
    const Columns columns(table);
    table.samples.resize(patches.size());
    table.mean.resize(patches.size());
    std::vector<bool> seen(patches.size(), false);
    table.environment.resize(patches.size());
    table.blocked.resize(patches.size());
    std::size_t done = 0;
    visibility.rows(patches, [&](std::uint32_t patch, const VisibilityRow& row) {
        const std::uint32_t k = table.index.row_of(patch);
        if (k == RowIndex::no_row || seen[k]) {
            throw Error(fmt::format("row {} of the visibility came twice or unasked", patch));
        }
        seen[k] = true;
        SampledRow& sampled = table.samples[k];
        if (table.own.contains(k)) {
            sampled.end = size;
            add_samples(row, {0, size}, sampled.samples);
            table.mean[k] = mean_share(sampled.samples);
        } else {
            sampled.first = columns.first.first;
            sampled.end = columns.first.end;
            sampled.second = columns.second.first;
            sampled.samples.reserve(columns.first.end - columns.first.first + columns.second.end -
                                    columns.second.first);
            add_samples(row, columns.first, sampled.samples);
            add_samples(row, columns.second, sampled.samples);
        }
        table.environment[k] = row.environment;
        table.blocked[k] = row.blocked;
        ++done;
        if (progress && !progress(done, patches.size())) {
            throw Cancelled();
        }
    });
    if (done != patches.size()) {
        throw Error(fmt::format("{} gave {} of {} rows of the visibility", visibility.renderer(), done,
                                patches.size()));
    }
    if (divided) {
        table.mean = joined(table.mean);
    }
    return table;
}

} // namespace hemi
