// The Python module raya._engine: renders, scenes and loads with numpy arrays. The package around it is raya/.
#include "host/base/module.hpp"

#include <dlfcn.h>
#include <pybind11/pybind11.h>

#include "host/base/say.hpp"
#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/python/session.hpp"
#include "host/torus/torus_result.hpp"
#include "host/version.hpp"
#include "kernels/shared/traffic.h"

namespace {

// What raya loads late lies beside this module, not beside the interpreter.
std::filesystem::path own_file() {
    Dl_info info{};
    ::dladdr(reinterpret_cast<void*>(&own_file), &info);
    return std::filesystem::canonical(info.dli_fname);
}

}  // namespace

PYBIND11_MODULE(_engine, module) {
    using namespace raya;
    set_own_file(own_file());
    set_verbosity(kSilent);  // warnings are Python's
    auto& refused = pybind11::register_exception<UserError>(module, "InputError", PyExc_ValueError);
    refused.doc() = "What was asked for cannot be done.";
    pybind11::register_exception<Standstill>(module, "Deadlock", refused).doc() =
        "Buffers of a torus are too short for its packets.";
    pybind11::register_exception<DoesNotFit>(module, "DoesNotFit", refused).doc() =
        "A PE or node cannot hold its part of the scene.";
    pybind11::register_exception<DeviceError>(module, "DeviceError", PyExc_RuntimeError).doc() =
        "There is no such OpenCL device, or it failed.";
    module.attr("STATUS_WORDS") = std::uint32_t{RAYA_STATUS_WORDS};  // of a node, to the host in each superstep
    module.attr("__version__") = raya_version();
    add_scenes(module);
    add_renders(module);
    add_loads(module);
    add_study_settings(module);
}
