// The Python module raya._engine, which loads and renders scenes and models loads. The package in raya/ imports it.
#include "host/base/module.hpp"

#include <dlfcn.h>
#include <pybind11/pybind11.h>

#include "host/base/log.hpp"
#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/python/session.hpp"
#include "host/torus/torus_result.hpp"
#include "host/version.hpp"
#include "kernels/shared/traffic.h"

namespace {

// Returns the path of this shared object. raya searches for its shared libraries in the folder of this file, not in the
// folder of the Python interpreter.
std::filesystem::path this_module_file() {
    Dl_info info{};
    ::dladdr(reinterpret_cast<void*>(&this_module_file), &info);
    return std::filesystem::canonical(info.dli_fname);
}

}  // namespace

PYBIND11_MODULE(_engine, module) {
    using namespace raya;
    set_program_file(this_module_file());
    set_verbosity(kErrorsOnly);  // warnings become Python warnings instead
    auto& input_error = pybind11::register_exception<UserError>(module, "InputError", PyExc_ValueError);
    input_error.doc() = "Invalid input or options.";
    pybind11::register_exception<DoesNotFit>(module, "DoesNotFit", input_error).doc() =
        "A part of the scene does not fit into the memory of a PE or node.";
    pybind11::register_exception<DeviceError>(module, "DeviceError", PyExc_RuntimeError).doc() =
        "The OpenCL device was not found or failed.";
    // Number of 32-bit words that each torus node sends to the host in each superstep.
    module.attr("STATUS_WORDS") = std::uint32_t{RAYA_STATUS_WORDS};
    module.attr("__version__") = raya_version();
    add_scenes(module);
    add_renders(module);
    add_loads(module);
    add_study_settings(module);
}
