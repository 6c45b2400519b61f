// OpenCL's error codes in words, and the one way in which an OpenCL error leaves this layer: as a DeviceError.
#pragma once
#include <string>

#include "host/cl/driver.hpp"
#include "host/cl/opencl.hpp"
#include "host/error.hpp"

namespace raya {

/// The name of an OpenCL error code as the headers spell it, e.g. "CL_INVALID_KERNEL_ARGS"; "unknown OpenCL error
/// -4711" for a code that no header or common driver defines. Codes: cl.h, cl_ext.h, and -9999 of NVIDIA's driver.
std::string error_name(cl_int code);

/// One line that says what to do about an error code; empty where nothing general can be said.
std::string error_remedy(cl_int code);

/// The DeviceError for a failed `call` ("clEnqueueCopyBuffer") while doing `what` ("copy 'rotate' from ... to ...").
DeviceError device_error(const std::string& call, cl_int code, const std::string& what);

/// Runs `action` and returns what it returns; a cl::Error in it becomes the DeviceError that also says `what` was done.
template <class Action>
decltype(auto) guarded(const std::string& what, Action&& action) {
    const DriverCall call(what.c_str());
    try {
        return action();
    } catch (const cl::Error& error) {
        throw device_error(error.what(), error.err(), what);
    }
}

}  // namespace raya
