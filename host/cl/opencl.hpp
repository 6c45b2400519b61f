// The one place that includes the OpenCL C++ bindings, so that every file sees them with the same macros.
//
// 1.2 is asked for on both sides: the layer needs nothing newer, and so the program also runs on drivers that never
// went further. Errors are exceptions (cl::Error), which guarded() in error_names.hpp turns into DeviceError.
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>
