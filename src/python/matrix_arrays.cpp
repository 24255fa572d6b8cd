#include "python/matrix_arrays.hpp"

#include "hemi/matrix/product.hpp"
#include "python/bindings.hpp"

#include <cstdint>
#include <limits>
#include <span>

namespace hemi::python {

namespace {

/// Offsets of rows in arrays that hold all entries.
template <class Index>
std::vector<Index> row_offsets(const FormFactorMatrix& matrix) {
    std::vector<Index> offsets{0};
    offsets.reserve(std::size_t{matrix.size()} + 1);
    for (const RowBlock& block : matrix.blocks()) {
        const auto before = static_cast<std::uint64_t>(offsets.back());
        for (std::size_t row = 1; row < block.begin.size(); ++row) {
            offsets.push_back(static_cast<Index>(before + block.begin[row]));
        }
    }
    return offsets;
}

/// One array of all blocks' `part`s.
template <class To, class From>
std::vector<To> joined(const FormFactorMatrix& matrix, RowArray<From> RowBlock::*part) {
    std::vector<To> all;
    all.reserve(matrix.entries());
    for (const RowBlock& block : matrix.blocks()) {
        all.insert(all.end(), (block.*part).begin(), (block.*part).end());
    }
    return all;
}

/// scipy wants columns and offsets of one type.
template <class Index>
py::object make_csr(const FormFactorMatrix& matrix) {
    const py::object csr = py::module_::import("scipy.sparse").attr("csr_matrix");
    const py::tuple parts =
        py::make_tuple(owned(joined<float>(matrix, &RowBlock::values)),
                       owned(joined<Index>(matrix, &RowBlock::columns)), owned(row_offsets<Index>(matrix)));
    return csr(parts, py::arg("shape") = py::make_tuple(matrix.size(), matrix.size()),
               py::arg("copy") = false);
}

} // namespace

py::object csr_matrix(const FormFactorMatrix& matrix) {
    const bool small = matrix.entries() <= std::uint64_t{std::numeric_limits<std::int32_t>::max()};
    return small ? make_csr<std::int32_t>(matrix) : make_csr<std::int64_t>(matrix);
}

py::object visibility_codes(const FormFactorMatrix& matrix) {
    return matrix.has_visibility() ? py::object(owned(joined<std::uint8_t>(matrix, &RowBlock::visibility)))
                                   : py::object(py::none());
}

Doubles multiply(const FormFactorMatrix& matrix, const Doubles& right) {
    const std::size_t size = matrix.size();
    if (right.ndim() < 1 || right.ndim() > 2 || static_cast<std::size_t>(right.shape(0)) != size) {
        throw InvalidArgument(fmt::format("F @ x: x must have the shape [{0}] or [{0}, channels]", size));
    }
    const std::size_t channels = right.ndim() == 2 ? static_cast<std::size_t>(right.shape(1)) : 1;
    Doubles product(std::vector<py::ssize_t>(right.shape(), right.shape() + right.ndim()));
    const std::span<const double> from(right.data(), size * channels);
    const std::span<double> to(product.mutable_data(), size * channels);
    const py::gil_scoped_release release;
    hemi::multiply(matrix, from, static_cast<std::uint32_t>(channels), to);
    return product;
}

py::array_t<double> share_of_rows(const FormFactorMatrix& matrix, std::vector<double> RowBlock::*share) {
    std::vector<double> all;
    all.reserve(matrix.size());
    for (const RowBlock& block : matrix.blocks()) {
        all.insert(all.end(), (block.*share).begin(), (block.*share).end());
    }
    return owned(std::move(all));
}

py::array_t<bool> known_rows(const FormFactorMatrix& matrix) {
    py::array_t<bool> known(matrix.size());
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        known.mutable_at(i) = matrix.known(i);
    }
    return known;
}

py::array_t<double> row_sums_of(const FormFactorMatrix& matrix) {
    std::vector<double> sums;
    sums.reserve(matrix.size());
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        sums.push_back(matrix.row(i).sum());
    }
    return owned(std::move(sums));
}

} // namespace hemi::python
