// Kernel sources: embedded in the program, or read from a folder while they are being developed.
#pragma once
#include <filesystem>
#include <string>

namespace raya {

/// The text of `file` (a path below kernels/, "ring/trace.cl") with its includes put in, each once, and #line kept, so
/// that a build log names file and line. Includes start at the project's root ("kernels/geometry/ray.clh"); what has no
/// folder in its name lies beside the file that includes it. Read from `folder` where it is not empty (`--kernel-dir`).
/// Throws UserError for a file or an include that does not exist.
std::string kernel_source(const std::string& file, const std::filesystem::path& folder = {});

/// The same for a `text` that is no file of kernels/; `name` stands for it in a build log.
std::string expand_kernel_source(const std::string& text, const std::string& name,
                                 const std::filesystem::path& folder = {});

}  // namespace raya
