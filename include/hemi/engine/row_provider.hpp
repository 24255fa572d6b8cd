#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace hemi {

/// A way to compute rows of one kind, patch by patch. Implementations differ in method and device, never in
/// meaning. One interface for both kinds of rows, so that whatever stands between a provider and its user
/// (checkpoints, observers) is written once.
/// @tparam Row  a view of one row: RowView (form factors) or VisibilityRow
template <class Row>
class BasicRowProvider {
public:
    using RowType = Row; ///< what it provides
    /// Receives one row. `patch` is the row's index i; the view is valid during the call only.
    /// May throw; the provider then stops and passes the exception on.
    using Sink = std::function<void(std::uint32_t patch, const Row& row)>;

    virtual ~BasicRowProvider() = default;

    /// Number of rows: that of the patches, whose columns are as many, or of points (point_rows.hpp).
    [[nodiscard]] virtual std::uint32_t size() const = 0;

    /// What computes: for example the OpenGL renderer string.
    [[nodiscard]] virtual std::string renderer() const = 0;

    /// Computes the rows of `patches` (ascending, no duplicates) and hands each to `sink`, from the calling
    /// thread. Rows of one block of FormFactorMatrix::block_rows come in order; blocks come in any order.
    /// @throws Cancelled where the provider computes itself and stop_if_interrupted() does, asked before
    ///   every row.
    virtual void rows(std::span<const std::uint32_t> patches, const Sink& sink) = 0;

    /// Hemicubes drawn so far for rows that were delivered; 0 by a method that draws none.
    [[nodiscard]] virtual std::uint64_t hemicubes() const { return 0; }
};

/// A way to compute rows of F.
using RowProvider = BasicRowProvider<RowView>;
/// Receives one row of F.
using RowSink = RowProvider::Sink;

/// Rows of `patches` as a matrix; the other rows stay unknown.
/// @param provider  computes the rows
/// @param patches   ascending, no duplicates
/// @param progress  called after every row with the rows done so far; may be empty
/// @throws Cancelled when progress returns false.
[[nodiscard]] FormFactorMatrix compute_matrix(RowProvider& provider, std::span<const std::uint32_t> patches,
                                              const Progress& progress = {});

/// All rows.
[[nodiscard]] FormFactorMatrix compute_matrix(RowProvider& provider, const Progress& progress = {});

/// What rows will need, see estimate_matrix().
struct MatrixEstimate {
    double entries_per_row = 0.0;   ///< mean over the sample
    std::uint64_t memory_bytes = 0; ///< of the matrix, with the 20 % on top
    double seconds = 0.0;           ///< for all rows, at the sample's speed
};

/// Bytes that compute_matrix() needs.
/// @param entries_per_row  mean
/// @param rows             that are wanted
/// @param size             N
[[nodiscard]] std::uint64_t matrix_memory(double entries_per_row, std::uint64_t rows, std::uint32_t size);

/// What compute_matrix() will need for the rows of `patches`, from up to `samples` of them spread evenly,
/// which are computed and thrown away.
[[nodiscard]] MatrixEstimate estimate_matrix(RowProvider& provider, std::span<const std::uint32_t> patches,
                                             std::uint32_t samples = 64);

} // namespace hemi
