#include "python/arrays.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <string>

namespace hemi::python {

namespace {

std::string shape_text(const py::array& array) {
    std::string text;
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
        text += fmt::format("{}{}", axis > 0 ? ", " : "", array.shape(axis));
    }
    return "[" + text + "]";
}

} // namespace

ChannelValues::ChannelValues(const py::object& values, std::string_view what)
    : values_(decltype(values_)::ensure(values)), what_(what) {
    if (!values_) {
        throw py::type_error(fmt::format("{}: must be a number or an array of numbers", what));
    }
    if (values_.ndim() > 2) {
        throw InvalidArgument(fmt::format("{} of shape {}: must have at most two axes, the second of which "
                                          "are channels",
                                          what, shape_text(values_)));
    }
}

std::size_t ChannelValues::channels() const {
    return values_.ndim() == 2 ? static_cast<std::size_t>(values_.shape(1)) : 1;
}

std::vector<double> ChannelValues::spread(std::size_t rows, std::size_t channels,
                                          std::string_view unit) const {
    const std::size_t given_rows = values_.ndim() > 0 ? static_cast<std::size_t>(values_.shape(0)) : 1;
    const std::size_t given_channels = this->channels();
    if ((given_rows != rows && given_rows != 1) || (given_channels != channels && given_channels != 1)) {
        throw InvalidArgument(fmt::format("{0} of shape {1}: must be a number or of shape [{2}], [1, {3}] or "
                                          "[{2}, {3}] ({4}, channels)",
                                          what_, shape_text(values_), rows, channels, unit));
    }
    const double* const data = values_.data();
    std::vector<double> result;
    result.reserve(rows * channels);
    for (std::size_t i = 0; i < rows; ++i) {
        const double* const row = data + (given_rows == 1 ? 0 : i * given_channels);
        for (std::size_t c = 0; c < channels; ++c) {
            result.push_back(row[given_channels == 1 ? 0 : c]);
        }
    }
    return result;
}

} // namespace hemi::python
