#include "engine/visibility_weighted/visibility_table.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

namespace hemi {

VisibilityTable sample_visibility(VisibilityProvider& visibility, std::span<const std::uint32_t> patches,
                                  std::uint32_t size, const Progress& progress) {
    VisibilityTable table{RowIndex(patches, size), {}, {}, {}};
    table.samples.resize(patches.size());
    table.environment.resize(patches.size());
    table.blocked.resize(patches.size());
    std::size_t done = 0;
    visibility.rows(patches, [&](std::uint32_t patch, const VisibilityRow& row) {
        const std::uint32_t k = table.index.row_of(patch);
        if (k == RowIndex::no_row || !table.samples[k].empty()) {
            throw Error(fmt::format("row {} of the visibility came twice or unasked", patch));
        }
        std::vector<VisibilitySample>& samples = table.samples[k];
        samples.resize(size);
        for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
            samples[row.columns[entry]] = {row.shares[entry], row.texels[entry]};
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
    return table;
}

} // namespace hemi
