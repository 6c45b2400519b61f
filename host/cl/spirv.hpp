// Kernels as SPIR-V (--il): clang and llvm-spirv compile the source, and the driver gets a program in the intermediate
// language (IL) SPIR-V instead of source.
#pragma once
#include <string>

#include "host/cl/opencl.hpp"

namespace raya {

/// Removes the word "--il" from build options. Returns true if it was there.
bool remove_il_option(std::string& options);

/// Adds "--il" to RAYA_BUILD_OPTIONS, so that this process and its child processes build all kernels from SPIR-V.
void use_il();

/// Returns true if RAYA_BUILD_OPTIONS contains "--il".
bool uses_il();

/// Returns the IL versions that the device accepts, such as "SPIR-V_1.0 SPIR-V_1.2"; empty if it accepts none.
std::string il_versions(const cl::Device& device);

/// Compiles `source` with `options`, separated by blanks, to SPIR-V and makes a program of it, which is not built
/// yet. `operation` is for messages. Throws DeviceError, with options and the compilers' messages, if the device does
/// not accept SPIR-V or if a compiler is missing or fails. Throws cl::Error if the driver rejects the program.
cl::Program spirv_program(const cl::Context& context, const cl::Device& device, const std::string& source,
                          const std::string& options, const std::string& operation);

}  // namespace raya
