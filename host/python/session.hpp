// A device that is open, and one render on it.
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

/// A device with the programs that were built for it. One thread at a time renders on it; others wait.
class PythonSession {
  public:
    /// `device` as --device has it. DeviceError.
    explicit PythonSession(const std::string& device);

    const DeviceInfo& info() const { return session_.device(); }

    /// With the keyword arguments of `raya render`. UserError, DeviceError. The interpreter is free meanwhile; a signal
    /// that its handlers turn into an exception ends the render. `progress`: None, or called with the share done, 0..1.
    std::shared_ptr<Render> render(const Scene& scene, const py::dict& options, const py::object& progress);

    /// The session for that device that renders without one of their own share.
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
