// Kernel binaries installed with the program, so that the first render compiles nothing: files in the folder kernels/
// next to the modules, named by a hash of source, options, device and driver. `raya render --cache-kernels` writes
// them.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/opencl.hpp"

namespace raya {

using KernelBinary = std::vector<unsigned char>;

/// The binary file of a program built with `options`, as passed to the compiler; empty if there is no folder for it.
std::filesystem::path kernel_binary_file(const cl::Device& device, const std::string& source,
                                         const std::string& options);

/// Reads the file. Returns nothing if it does not exist, if users other than root, this user and the program's owner
/// may change it, or if the environment variable RAYA_BINARIES is "off". UserError if RAYA_BINARIES has another value.
std::optional<KernelBinary> read_kernel_binary(const std::filesystem::path& file);

/// Writes the file atomically and creates its folder. UserError if that fails.
void write_kernel_binary(const std::filesystem::path& file, const KernelBinary& binary);

}  // namespace raya
