// An open device, for renders from Python.
#pragma once
#include <pybind11/pybind11.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "host/cl/commands.hpp"
#include "host/cli/render_command.hpp"
#include "host/python/convert.hpp"

namespace raya {

/// A device with the programs built for it. Renders of several threads run one after another.
class PythonSession {
  public:
    /// `device`: as for --device. DeviceError.
    explicit PythonSession(const std::string& device);

    const DeviceInfo& info() const { return session_.device(); }

    /// Renders with the keyword arguments of raya.render(). Releases the interpreter lock; an exception raised by a
    /// Python signal handler ends the render. `progress`: None, or a function called with the completed share, 0..1.
    /// UserError, DeviceError.
    std::shared_ptr<Render> render(const Scene& scene, const py::dict& options, const py::object& progress);

    /// The shared session of a device, for renders without a session argument.
    static PythonSession& shared(const std::string& device);

  private:
    cl::Device device_;
    Session session_;
    std::mutex mutex_;
};

void add_scenes(py::module_& module);
void add_renders(py::module_& module);
void add_loads(py::module_& module);
void add_study_settings(py::module_& module);

}  // namespace raya
