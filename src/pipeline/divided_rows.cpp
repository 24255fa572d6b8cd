#include "pipeline/divided_rows.hpp"

#include "engine/raw_row.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/engine/engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace hemi {

namespace {

using Bytes = std::vector<std::byte>;

/// How the patches are shared out: whole blocks, in turn.
class Shares {
public:
    Shares(std::span<const std::uint32_t> patches, const Ranks& ranks) : counts_(ranks.size(), 0) {
        std::uint32_t block = 0;
        for (std::size_t k = 0; k < patches.size(); ++k) {
            constexpr std::uint32_t rows = FormFactorMatrix::block_rows;
            block += k > 0 && patches[k] / rows != patches[k - 1] / rows ? 1 : 0;
            const std::uint32_t rank = block % ranks.size();
            ++counts_[rank];
            if (rank == ranks.rank()) {
                own_.push_back(patches[k]);
            }
        }
    }

    [[nodiscard]] std::span<const std::uint32_t> own() const { return own_; }
    /// The most that a rank has.
    [[nodiscard]] std::size_t most() const { return *std::max_element(counts_.begin(), counts_.end()); }

private:
    std::vector<std::size_t> counts_;
    std::vector<std::uint32_t> own_;
};

/// What stands before the entries of a row.
struct RowHead {
    std::uint32_t patch;
    std::uint32_t entries;
    double environment;
    double blocked;
    std::uint64_t with_visibility;
};

/// Rows one after the other, as they travel.
void append(Bytes& bytes, std::uint32_t patch, const RawRow& row) {
    if (!row.joint.empty()) {
        throw Error("rows that tell of many patches by one number cannot be sent to other ranks");
    }
    const RowHead head{patch, static_cast<std::uint32_t>(row.columns.size()), row.environment, row.blocked,
                       row.visibility.empty() ? 0u : 1u};
    const auto add = [&bytes](std::span<const std::byte> part) {
        bytes.insert(bytes.end(), part.begin(), part.end());
    };
    add(std::as_bytes(std::span(&head, 1)));
    add(std::as_bytes(row.columns));
    add(std::as_bytes(row.values));
    add(std::as_bytes(row.visibility));
    bytes.resize((bytes.size() + sizeof(double) - 1) / sizeof(double) * sizeof(double));
}

/// Calls `visit(patch, row)` for all rows.
template <class Visit>
void for_rows(const Bytes& bytes, const Visit& visit) {
    std::size_t at = 0;
    while (at < bytes.size()) {
        RowHead head{};
        std::memcpy(&head, bytes.data() + at, sizeof(head));
        const std::size_t count = head.entries;
        const std::byte* const entries = bytes.data() + at + sizeof(head);
        const auto* const columns = reinterpret_cast<const std::uint32_t*>(entries);
        const auto* const values = reinterpret_cast<const float*>(columns + count);
        const auto* const visibility = reinterpret_cast<const std::uint8_t*>(values + count);
        const std::size_t codes = head.with_visibility != 0 ? count : 0;
        visit(
            head.patch,
            RowView{{columns, count}, {values, count}, {visibility, codes}, head.environment, head.blocked});
        at += sizeof(head) + count * (sizeof(std::uint32_t) + sizeof(float)) + codes;
        at = (at + sizeof(double) - 1) / sizeof(double) * sizeof(double);
    }
}

} // namespace

template <class Row>
void DividedRows<Row>::rows(std::span<const std::uint32_t> patches, const Sink& sink) {
    if (ranks().size() == 1) {
        own_.rows(patches, sink);
        return;
    }
    const Shares shares(patches, ranks());
    const std::size_t exchanges = (shares.most() + rows_at_once - 1) / rows_at_once;
    const std::uint64_t hemicubes_before = own_.hemicubes();
    Bytes finished;
    std::size_t exchanged = 0;
    const auto exchange = [&] {
        for (const Bytes& bytes : ranks().gather(finished)) {
            for_rows(bytes, [&sink](std::uint32_t patch, const RawRow& row) {
                sink(patch, row_from_raw<Row>(row));
            });
        }
        finished.clear();
        ++exchanged;
    };
    if (!shares.own().empty()) {
        std::size_t done = 0;
        own_.rows(shares.own(), [&](std::uint32_t patch, const Row& row) {
            append(finished, patch, raw_row(row));
            if (++done % rows_at_once == 0) {
                exchange();
            }
        });
    }
    while (exchanged < exchanges) {
        exchange();
    }
    compare_ranks(hemicubes_before);
}

template <class Row>
void DividedRows<Row>::compare_ranks(std::uint64_t hemicubes_before) {
    if (ranks().size() == 1) {
        return;
    }
    const std::uint64_t drawn = own_.hemicubes() - hemicubes_before;
    for (const std::uint64_t of_rank : gather_values(ranks(), std::span(&drawn, 1))) {
        of_others_ += of_rank;
    }
    of_others_ -= drawn;
    const std::string renderer = renderer_of_rows(own_.renderer());
    const std::vector<Bytes> all = ranks().gather(std::as_bytes(std::span(renderer)));
    const auto text = [&all](std::size_t rank) {
        return std::string(reinterpret_cast<const char*>(all[rank].data()), all[rank].size());
    };
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        if (all[rank] != all[0]) {
            throw InvalidArgument(fmt::format("rank {} computes rows by {}, the first by {}; name a device "
                                              "that all of them have",
                                              rank + 1, text(rank), text(0)),
                                  {"device"});
        }
    }
}

template class DividedRows<RowView>;
template class DividedRows<VisibilityRow>;

} // namespace hemi
