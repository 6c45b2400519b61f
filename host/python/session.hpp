// An open device, for renders from Python.
#pragma once
#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "host/cl/commands.hpp"
#include "host/cli/render_command.hpp"
#include "host/python/convert.hpp"

namespace raya {

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
    /// Throws DeviceError in a process that was forked from the first one.
    static void check_process();

    cl::Device device_;
    Session session_;
    std::mutex mutex_;
    std::atomic<std::thread::id> renderer_{};  // the thread that renders
};

/// Smart pointer that holds a render in the Python class Result.
using Result = std::shared_ptr<Render>;
using ResultClass = py::class_<Render, Result>;

/// Adds the members for renders on a torus to the Python class Result.
void add_torus_results(py::module_& module, ResultClass& result);

// Each function below adds the functions and classes of one source file to the Python module.
void add_scenes(py::module_& module);
void add_renders(py::module_& module);
void add_loads(py::module_& module);
void add_study_settings(py::module_& module);

}  // namespace raya
