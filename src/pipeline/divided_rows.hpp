#pragma once

#include "hemi/engine/row_provider.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace hemi {

/// Rows of a provider that every rank has, shared out among the ranks: each computes every N-th block of
/// rows, and all get all of them. They come in another order than from the provider, and are to the bit what
/// it gives. Memory: what `rows_at_once` rows of every rank take.
/// @tparam Row  RowView or VisibilityRow
template <class Row>
class DividedRows : public BasicRowProvider<Row> {
public:
    using Sink = typename BasicRowProvider<Row>::Sink;

    /// @param own  what this rank computes with; must outlive this
    explicit DividedRows(BasicRowProvider<Row>& own) : own_(own) {}
    /// Keeps it.
    explicit DividedRows(std::unique_ptr<BasicRowProvider<Row>> own) : kept_(std::move(own)), own_(*kept_) {}

    [[nodiscard]] std::uint32_t size() const override { return own_.size(); }
    [[nodiscard]] std::string renderer() const override { return own_.renderer(); }
    [[nodiscard]] std::uint64_t hemicubes() const override { return own_.hemicubes() + of_others_; }
    /// @throws InvalidArgument if another rank's rows are by another kind of device
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override;

    /// What this rank computes with.
    [[nodiscard]] BasicRowProvider<Row>& own() noexcept { return own_; }

    /// Counts the hemicubes that the others drew, when all are done.
    /// @param hemicubes_before  that this rank had drawn before
    /// @throws InvalidArgument if another rank's rows are by another kind of device
    void compare_ranks(std::uint64_t hemicubes_before);

private:
    static constexpr std::size_t rows_at_once = 64;

    std::unique_ptr<BasicRowProvider<Row>> kept_;
    BasicRowProvider<Row>& own_;
    std::uint64_t of_others_ = 0; ///< hemicubes
};

/// What a rank computes with, of rows that may be shared out.
template <class Row>
[[nodiscard]] BasicRowProvider<Row>& rows_of_rank(BasicRowProvider<Row>& rows) {
    auto* const divided = dynamic_cast<DividedRows<Row>*>(&rows);
    return divided != nullptr ? divided->own() : rows;
}

} // namespace hemi
