#include "host/cl/kernel_source.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "host/base/whole_file.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

std::string read_kernel_file(const std::string& file, std::filesystem::path folder) {
    if (const char* const variable = std::getenv("RAYA_KERNEL_DIR"); folder.empty() && variable != nullptr)
        folder = variable;
    if (folder.empty()) {
        const auto found = embedded_files().find("kernels/" + file);
        if (found == embedded_files().end())
            throw UserError(fmt::format("raya has no built-in kernel file '{}'", file));
        return found->second;
    }
    try {
        return read_input(folder / file);
    } catch (const UnreadableFile& error) {
        throw UserError(
            fmt::format("cannot read kernel file '{}': {}; --kernel-dir must be a folder like raya's own kernels/",
                        (folder / file).string(), error.what()));
    }
}

// If `line`, a line of `file`, is an #include line, returns the included file as a path below kernels/, else an empty
// string. A name without a folder is relative to the folder of `file`.
std::string included_file(const std::string& line, const std::string& file) {
    constexpr std::string_view kInclude = "#include \"", kKernels = "kernels/";
    if (!line.starts_with(kInclude)) return {};
    const std::string name = line.substr(kInclude.size(), line.find('"', kInclude.size()) - kInclude.size());
    if (name.starts_with(kKernels)) return name.substr(kKernels.size());
    return name.find('/') == std::string::npos ? (std::filesystem::path(file).parent_path() / name).string() : name;
}

void append_expanded(std::string& source, const std::string& text, const std::string& name,
                     const KernelSources& sources, std::set<std::string>& included_files) {
    source += fmt::format("#line 1 \"{}\"\n", name);
    std::istringstream lines(text);
    int number = 0;
    bool has_include = false;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const std::string included = included_file(line, name);
        if (included.empty())
            source += line + '\n';
        else if (included_files.insert(included).second)
            append_expanded(source, kernel_file(included, sources), included, sources, included_files);
        has_include |= !included.empty();
        // The compiler ignores the #line directives of an include that an #if skips, so the end of the #if needs one.
        const bool may_end_skipped_include = has_include && (line.starts_with("#el") || line.starts_with("#endif"));
        if (!included.empty() || may_end_skipped_include) source += fmt::format("#line {} \"{}\"\n", number + 1, name);
    }
}

}  // namespace

std::string patched_text(std::string text, const std::string& file, const std::vector<SourcePatch>& patches) {
    for (const SourcePatch& patch : patches) {
        if (patch.file != file) continue;
        const std::size_t at = text.find(patch.find);
        if (patch.find.empty() || at == std::string::npos)
            throw std::logic_error(fmt::format("patch of {}: no text '{}'", file, patch.find));
        if (text.find(patch.find, at + 1) != std::string::npos)
            throw std::logic_error(fmt::format("patch of {}: more than one text '{}'", file, patch.find));
        text.replace(at, patch.find.size(), patch.replace);
    }
    return text;
}

std::string kernel_file(const std::string& file, const KernelSources& sources) {
    return patched_text(read_kernel_file(file, sources.folder), file, sources.patches);
}

std::string kernel_source(const std::string& file, const KernelSources& sources) {
    return expand_kernel_source(kernel_file(file, sources), file, sources);
}

std::string expand_kernel_source(const std::string& text, const std::string& name, const KernelSources& sources) {
    std::string source;
    std::set<std::string> included_files = {name};
    append_expanded(source, text, name, sources, included_files);
    return source;
}

void check_kernel_folder(const KernelSources& sources) {
    constexpr std::string_view kKernels = "kernels/";
    for (const auto& [name, text] : embedded_files())
        if (name.starts_with(kKernels) && name.ends_with(".cl"))
            kernel_source(name.substr(kKernels.size()), sources);  // throws if a file is missing
}

void check_patches(const KernelSources& sources) {
    for (const SourcePatch& patch : sources.patches) kernel_file(patch.file, sources);  // throws on failure
}

}  // namespace raya
