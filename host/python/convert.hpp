// Values between Python and the engine.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/ring/schedule.hpp"

namespace raya {

namespace py = pybind11;

using CostArray = py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>;

/// Keyword arguments as words of a command line: offset=16 is "--offset=16", strict=True "--strict", strict=False and
/// None nothing, from_=(1, 2, 3) "--from=1,2,3"; of `light` each element of a list of lights is an option of its own.
/// TypeError for other values.
std::vector<std::string> option_words(const py::dict& options);

/// The same document, as Python's json module reads it.
py::object python_of(const Json& json);

/// An array that views memory of `owner`, an object of Python that keeps it; it cannot be written.
template <class T>
py::array view_of(std::span<const T> values, std::vector<py::ssize_t> shape, const py::object& owner) {
    py::array_t<T> array(std::move(shape), values.data(), owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

/// An array of its own, [n].
template <class T>
py::array copy_of(const std::vector<T>& values) {
    return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// Of an array [H, W] of whole numbers. ValueError for another shape or numbers below 0.
CostImage cost_image_of(const py::array& cost);

}  // namespace raya
