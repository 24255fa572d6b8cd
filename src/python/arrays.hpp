#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace hemi::python {

namespace py = pybind11;

/// A read-only array that shows what `owner`, which it keeps alive, holds; nothing is copied.
template <class T>
py::array_t<T> view(std::span<const T> values, std::vector<py::ssize_t> shape, const py::object& owner) {
    py::array_t<T> array(std::move(shape), values.data(), owner);
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
}

/// The same with one axis.
template <class T>
py::array_t<T> view(std::span<const T> values, const py::object& owner) {
    return view(values, {static_cast<py::ssize_t>(values.size())}, owner);
}

/// An array that takes over a vector; nothing is copied.
template <class T>
py::array_t<T> owned(std::vector<T>&& values, std::vector<py::ssize_t> shape) {
    auto kept = std::make_unique<std::vector<T>>(std::move(values));
    const T* const data = kept->data();
    const py::capsule owner(kept.get(), [](void* pointer) { delete static_cast<std::vector<T>*>(pointer); });
    static_cast<void>(kept.release()); // the capsule deletes it
    return py::array_t<T>(std::move(shape), data, owner);
}

template <class T>
py::array_t<T> owned(std::vector<T>&& values) {
    const auto size = static_cast<py::ssize_t>(values.size());
    return owned(std::move(values), {size});
}

/// Values of rows (faces or patches) in channels, given as a number (for all), one axis (a value a row) or
/// two axes, either of which may be 1 long.
class ChannelValues {
public:
    /// @param what  for messages: "reflectance"
    /// @throws TypeError if it is no array of numbers; InvalidArgument for more axes
    ChannelValues(const py::object& values, std::string_view what);

    /// 1 where one value is for all channels.
    [[nodiscard]] std::size_t channels() const;
    /// Channel c of row i at [i·channels + c].
    /// @param unit  what a row is, for messages: "faces"
    /// @throws InvalidArgument if the array has neither that shape nor 1 in its place
    [[nodiscard]] std::vector<double> spread(std::size_t rows, std::size_t channels,
                                             std::string_view unit) const;

private:
    py::array_t<double, py::array::c_style | py::array::forcecast> values_;
    std::string_view what_;
};

} // namespace hemi::python
