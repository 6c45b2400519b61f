// Names and remedies of OpenCL error codes; conversion of cl::Error to DeviceError, the only type of exception for
// OpenCL errors outside host/cl.
#pragma once
#include <string>

#include "host/cl/driver.hpp"
#include "host/cl/opencl.hpp"
#include "host/error.hpp"

namespace raya {

/// Returns the name of an OpenCL error code as in OpenCL's headers, e.g. "CL_INVALID_KERNEL_ARGS", or "unknown OpenCL
/// error -4711". Sources of the codes: cl.h, cl_ext.h, and NVIDIA's driver for -9999.
std::string error_name(cl_int code);

/// Returns the remedy for an error code, one line; empty if the code has no common remedy.
std::string error_remedy(cl_int code);

/// Makes the DeviceError for an OpenCL `call` ("clEnqueueCopyBuffer") that failed with `code` during the operation
/// `operation` ("'rotate': copying ...").
DeviceError device_error(const std::string& call, cl_int code, const std::string& operation);

/// Runs `action` and returns its result. Converts a cl::Error into a DeviceError, whose message contains `operation`.
template <class Action>
decltype(auto) guarded(const std::string& operation, Action&& action) {
    const DriverCall call(operation.c_str());
    try {
        return action();
    } catch (const cl::Error& error) {
        throw device_error(error.what(), error.err(), operation);
    }
}

}  // namespace raya
