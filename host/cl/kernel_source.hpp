// Kernel sources: embedded in raya's executable, or read from a folder during development. Patches inject faults into
// kernels for tests.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace raya {

/// Replaces the text `find`, which may span several lines, in `file`, a path below kernels/ ("ring/trace.cl").
struct SourcePatch {
    std::string file, find, replace;
};

/// Applies the patches for `file` to its `text`, in order. Throws std::logic_error, with file and text, unless the text
/// to replace occurs exactly once, because a fault that was not injected must not count as undetected.
std::string patched_text(std::string text, const std::string& file, const std::vector<SourcePatch>& patches);

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

}  // namespace raya
