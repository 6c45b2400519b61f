// An open device, for renders from Python.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/commands.hpp"
#include "host/cli/render_command.hpp"
#include "host/ring/mapping.hpp"

namespace raya {

// Conversion of values between Python and C++.

namespace py = pybind11;

/// Parses keyword arguments as options of `program`, or of its command `command`: offset=16 as "--offset=16",
/// strict=True as "--strict", from_=(1, 2, 3) as "--from=1,2,3", and a list of lights as one --light per element. Omits
/// arguments with the value False or None. Raises ValueError for True or False in a sequence. Throws UserError.
void parse_keywords(CLI::App& program, const py::dict& options, const std::string& command = {});

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

/// An open device with the OpenCL programs built for it. Renders from several threads run one after another.
class PythonSession {
  public:
    /// Opens the device that `device` selects, as the option --device does. Throws DeviceError.
    explicit PythonSession(const std::string& device);

    const DeviceInfo& info() const { return session_.device(); }

    /// Renders with the keyword arguments of raya.render(). Releases Python's global interpreter lock (GIL) during the
    /// render. An exception raised by a Python signal handler ends the render. `progress`: None, or a function that is
    /// called with the completed fraction, 0..1. Throws UserError, DeviceError.
    std::shared_ptr<Render> render(const Scene& scene, const py::dict& options, const py::object& progress);

    /// Returns the session of render() calls without a session argument: one session for each value of `device`.
    static PythonSession& shared(const std::string& device);

  private:
    cl::Device device_;
    Session session_;
    std::mutex mutex_;
    std::atomic<std::thread::id> renderer_{};  // the thread that renders
};

/// Smart pointer that holds a render in the Python class Result.
using Result = std::shared_ptr<Render>;
using ResultClass = py::class_<Render, Result>;

// Each function below adds the functions and classes of one source file to the Python module.
void add_renders(py::module_& module);
void add_loads(py::module_& module);

}  // namespace raya
