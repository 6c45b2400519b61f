// Binaries of kernels that came with the program, so that the first render needs no compiler: files in kernels/ beside
// its modules, named after source, options, device and driver. `raya render --keep-kernels` makes them.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/opencl.hpp"

namespace raya {

using KernelBinary = std::vector<unsigned char>;

/// The file of a program that is built with `options` as the compiler sees them; empty where there is no folder for it.
std::filesystem::path kernel_binary_file(const cl::Device& device, const std::string& source,
                                         const std::string& options);

/// What the file holds; nothing where there is none, where users other than root, this one and the program's owner may
/// change it, or where the environment variable RAYA_BINARIES is "off". UserError where it is anything else.
std::optional<KernelBinary> read_kernel_binary(const std::filesystem::path& file);

/// Writes the file whole, in a folder that is made. UserError where that cannot be.
void write_kernel_binary(const std::filesystem::path& file, const KernelBinary& binary);

}  // namespace raya
