// Kernel sources: embedded in the program, or read from a folder while they are being developed.
#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace raya {

/// Every file below kernels/, by its path from there. Defined in a file that the build makes.
const std::map<std::string, std::string>& embedded_kernel_files();

/// The text of `file` (a path below kernels/, "ring/trace.cl") with its includes put in, each once, and #line kept, so that a
/// build log names file and line. Read from `folder` where it is not empty (`--kernel-dir`).
/// Throws UserError for a file or an include that does not exist.
std::string kernel_source(const std::string& file, const std::filesystem::path& folder = {});

}  // namespace raya
