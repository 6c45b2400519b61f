// Kernel sources: embedded in raya's executable, or read from a folder during development. Patches inject faults into
// kernels for tests.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/cl/opencl.hpp"

namespace raya {

/// Replaces the text `find`, which may span several lines, in `file`, a path below kernels/ ("ring/trace.cl").
struct SourcePatch {
    std::string file, find, replace;
};

/// The origin of the kernels' source, patches to it, and additional build options.
struct KernelSources {
    std::filesystem::path folder{};      // argument of --kernel-dir, a folder like kernels/; empty: the embedded files
    std::vector<SourcePatch> patches{};  // injected faults, for tests
    std::vector<std::string> more_options{};  // appended to the build options, for tests and checks
};

/// Returns the patched text of `file` (a path below kernels/, "ring/trace.cl"). Throws UserError if the file does not
/// exist, std::logic_error as patched_text().
std::string kernel_file(const std::string& file, const KernelSources& sources = {});

/// Returns the patched text of `file` with all #include lines expanded. Each included file appears only once. #line
/// directives make build logs refer to the original files and lines. Include paths are relative to the project's root
/// ("kernels/geometry/ray.clh"); a name without a folder is relative to the including file.
std::string kernel_source(const std::string& file, const KernelSources& sources = {});

/// Expands the #include lines of a `text` that is not a file of kernels/. `name` appears in build logs. Patches apply
/// to the included files, not to `text`.
std::string expand_kernel_source(const std::string& text, const std::string& name, const KernelSources& sources = {});

/// Throws UserError unless `sources.folder` contains all kernel files that are embedded in raya, and all files that
/// they include.
void check_kernel_folder(const KernelSources& sources);

/// Throws as kernel_file() if a patch does not apply. Call this function before code that counts any exception as a
/// detected fault.
void check_patches(const KernelSources& sources);

// Kernels as SPIR-V (--il): clang and llvm-spirv compile the source, and the driver gets a program in the intermediate
// language (IL) SPIR-V instead of source.

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
