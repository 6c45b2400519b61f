// Conversion of values between Python and C++.
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

/// Converts keyword arguments to command-line arguments: offset=16 to "--offset=16", strict=True to "--strict",
/// from_=(1, 2, 3) to "--from=1,2,3", and a list of lights to one --light per element. Omits arguments with the value
/// False or None. Raises ValueError for True or False in a sequence.
std::vector<std::string> option_arguments(const py::dict& options);

/// Makes TYPE.__new__(), whose result would be without contents, raise TypeError with `remedy`. `type`: a class whose
/// objects only functions make.
void forbid_new(const py::object& type, const char* remedy);

/// Converts a JSON document to Python's dicts, lists, strings and numbers (by json.loads()).
py::object python_of(const Json& json);

/// Returns a read-only array of shape `shape` that refers to `values`, which belong to the Python object `owner`. The
/// array keeps `owner` alive.
template <class T>
py::array view_of(std::span<const T> values, std::vector<py::ssize_t> shape, const py::object& owner) {
    py::array_t<T> array(std::move(shape), values.data(), owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

/// Returns a copy of the n `values` as an array [n].
template <class T>
py::array copy_of(const std::vector<T>& values) {
    return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// Converts an array [height, width] of modelled cycles. Raises ValueError unless the array has two dimensions and its
/// elements are integers of 0 or more.
CostImage cost_image_of(const py::array& cost);

}  // namespace raya
