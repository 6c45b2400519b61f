// Kernel sources: embedded in the program, or read from a folder while they are being developed; and patches of them,
// the one way to put a fault into kernels on purpose.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace raya {

/// In `file`, a path below kernels/ ("ring/trace.cl"), `replace` takes the place of `find`, which may span lines.
struct SourcePatch {
    std::string file, find, replace;
};

/// The `text` of `file` with those of `patches` that name it, one after another. std::logic_error, with file and text,
/// where a patch does not find its text exactly once: a fault that is not put in must not count as one that nobody
/// sees.
std::string patched_text(std::string text, const std::string& file, const std::vector<SourcePatch>& patches);

/// Where kernels come from, and how they are changed.
struct KernelSources {
    std::filesystem::path folder{};           // `--kernel-dir`: a folder like kernels/; empty: the program's own
    std::vector<SourcePatch> patches{};       // of tests
    std::vector<std::string> more_options{};  // behind the build options: of tests and checks
};

/// The text of `file` (a path below kernels/, "ring/trace.cl"), patched. Throws UserError for a file that does not
/// exist, std::logic_error as patched_text() does.
std::string kernel_file(const std::string& file, const KernelSources& sources = {});

/// The same with its includes put in, each once, and #line kept, so that a build log names file and line. Includes
/// start at the project's root ("kernels/geometry/ray.clh"); what has no folder in its name lies beside the file that
/// includes it.
std::string kernel_source(const std::string& file, const KernelSources& sources = {});

/// The same for a `text` that is no file of kernels/; `name` stands for it in a build log, patches leave it alone.
std::string expand_kernel_source(const std::string& text, const std::string& name, const KernelSources& sources = {});

/// UserError unless every kernel of the program is in the folder, with all that it includes.
void check_folder(const KernelSources& sources);

/// Throws as kernel_file() does unless every patch fits its file: before something that takes exceptions for a fault
/// seen.
void check_patches(const KernelSources& sources);

}  // namespace raya
