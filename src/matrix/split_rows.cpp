#include "matrix/split_rows.hpp"

#include "hemi/core/error.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace hemi {

namespace {

constexpr std::uint32_t none = 0xFFFFFFFFu;

struct Entry {
    std::uint32_t column;
    float value;
    std::uint8_t visibility;
};

void append(RowBlock& block, const Entry& entry, bool with_visibility) {
    block.columns.push_back(entry.column);
    block.values.push_back(entry.value);
    if (with_visibility) {
        block.visibility.push_back(entry.visibility);
    }
}

Entry entry_of(const RowView& row, std::size_t k, std::uint32_t column) {
    return {column, row.values[k], row.visibility.empty() ? std::uint8_t{0} : row.visibility[k]};
}

} // namespace

FormFactorMatrix split_rows(const FormFactorMatrix& old, const FormFactorMatrix& fresh,
                            std::span<const std::uint32_t> parents, std::span<const double> areas) {
    const std::uint32_t size = fresh.size();
    if (parents.size() != size || areas.size() != size) {
        throw InvalidArgument("split rows: parents and areas do not fit the finer mesh");
    }
    const bool with_visibility = fresh.has_visibility() || old.has_visibility();
    if (fresh.entries() > 0 && old.entries() > 0 && old.has_visibility() != fresh.has_visibility()) {
        throw InvalidArgument("split rows: either all rows have visibilities or none");
    }
    std::vector<std::uint32_t> now(old.size(), none); // where a patch that was not split is
    for (std::uint32_t k = 0; k < size; ++k) {
        if (!fresh.known(k)) {
            now[parents[k]] = k;
        }
    }
    // What parts send to the others, the other way round.
    std::vector<std::vector<Entry>> to_parts(size);
    for (std::uint32_t part = 0; part < size; ++part) {
        const RowView row = fresh.row(part);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            const std::uint32_t other = row.columns[k];
            if (!fresh.known(other)) {
                Entry entry = entry_of(row, k, part);
                entry.value =
                    static_cast<float>(static_cast<double>(entry.value) * areas[part] / areas[other]);
                to_parts[other].push_back(entry);
            }
        }
    }
    FormFactorMatrix result(size);
    for (std::uint32_t first = 0; first < size; first += FormFactorMatrix::block_rows) {
        RowBlock block;
        block.first_row = first;
        block.begin.push_back(0);
        for (std::uint32_t k = first; k < std::min(size, first + FormFactorMatrix::block_rows); ++k) {
            const bool is_part = fresh.known(k);
            const RowView row = is_part ? fresh.row(k) : old.row(parents[k]);
            double environment = row.environment;
            if (is_part) {
                for (std::size_t e = 0; e < row.columns.size(); ++e) {
                    append(block, entry_of(row, e, row.columns[e]), with_visibility);
                }
            } else {
                std::vector<Entry> entries = std::move(to_parts[k]);
                double sum = 0.0;
                for (std::size_t e = 0; e < row.columns.size(); ++e) {
                    if (now[row.columns[e]] != none) {
                        entries.push_back(entry_of(row, e, now[row.columns[e]]));
                    }
                }
                std::sort(entries.begin(), entries.end(),
                          [](const Entry& a, const Entry& b) { return a.column < b.column; });
                for (const Entry& entry : entries) {
                    append(block, entry, with_visibility);
                    sum += static_cast<double>(entry.value);
                }
                if (environment > 0.0) {
                    environment = std::max(0.0, environment + row.sum() - sum);
                }
            }
            block.begin.push_back(block.columns.size());
            block.environment.push_back(environment);
            block.blocked.push_back(row.blocked);
            block.known.push_back(is_part || old.known(parents[k]) ? 1 : 0);
        }
        result.set_block(std::move(block));
    }
    return result;
}

} // namespace hemi
