// Names and remedies of OpenCL error codes; conversion of cl::Error to DeviceError, the only error type of this layer.
#pragma once
#include <string>

#include "host/cl/driver.hpp"
#include "host/cl/opencl.hpp"
#include "host/error.hpp"

namespace raya {

/// The name of an OpenCL error code as in the headers, e.g. "CL_INVALID_KERNEL_ARGS", or "unknown OpenCL error -4711".
/// Source of the codes: cl.h, cl_ext.h, and -9999 of NVIDIA's driver.
std::string error_name(cl_int code);

/// The remedy for an error code, one line; empty if the code has no common remedy.
std::string error_remedy(cl_int code);

/// Makes the DeviceError for an OpenCL `call` ("clEnqueueCopyBuffer") that failed with `code` during the operation
/// `what` ("'rotate': copying ...").
DeviceError device_error(const std::string& call, cl_int code, const std::string& what);

/// Runs `action` and returns its result. Converts a cl::Error into a DeviceError; `what` names the operation in its
/// message.
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
