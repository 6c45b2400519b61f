// The only file that includes the OpenCL C++ bindings, so that all files use the same macros.
//
// Target and minimum version are 1.2: the host needs nothing newer, and some drivers support nothing newer. Errors are
// exceptions (cl::Error), which guarded() in error_names.hpp converts to DeviceError.
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>
