// Kernel binaries, installed with raya so that the first render compiles nothing. They are files in the folder kernels/
// of module_folder(). The name of a file is a hash of source, options, device and driver. `raya render --cache-kernels`
// writes them.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/opencl.hpp"

namespace raya {

using KernelBinary = std::vector<unsigned char>;

/// Returns the path of the binary file of an OpenCL program built from `source` with `options`, as passed to the
/// compiler; empty if module_folder() fails.
std::filesystem::path kernel_binary_file(const cl::Device& device, const std::string& source,
                                         const std::string& options);

/// Reads a binary file. Returns nothing if the file cannot be read, if users other than root, this user and the owner
/// of raya's executable may change the file, or if the environment variable RAYA_BINARIES is "off". Throws UserError if
/// RAYA_BINARIES is neither "off" nor empty.
std::optional<KernelBinary> read_kernel_binary(const std::filesystem::path& file);

/// Creates the file's folder if necessary and writes the file atomically. Throws UserError on failure.
void write_kernel_binary(const std::filesystem::path& file, const KernelBinary& binary);

}  // namespace raya
