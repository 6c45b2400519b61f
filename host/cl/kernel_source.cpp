#include "host/cl/kernel_source.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "host/base/child_process.hpp"
#include "host/base/encoding.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/program.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

std::string read_kernel_file(const std::string& file, std::filesystem::path folder) {
    if (folder.empty()) folder = environment_value("RAYA_KERNEL_DIR");
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
    lines.exceptions(std::ios::badbit);  // a lack of memory must not end the text
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

/// Applies the patches for `file` to its `text`, in order. Throws std::logic_error, with file and text, unless the text
/// to replace occurs exactly once, because a fault that was not injected must not count as undetected.
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

}  // namespace

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

namespace {

constexpr const char* kIlOption = "--il";

// Runs a compiler. Throws DeviceError, with its messages, unless it succeeds.
void run_compiler(const std::vector<std::string>& arguments, const std::string& operation) {
    Child compiler(arguments, STDERR_FILENO);
    std::string log;
    std::array<char, 4096> block{};
    for (std::optional<std::size_t> count; count != 0u; log.append(block.data(), count.value_or(0)))
        count = compiler.read(block.data(), block.size(), std::chrono::seconds(1));
    const int status = compiler.wait();
    if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
        throw DeviceError(
            fmt::format("{0}: --il cannot run {1}; remedy: install clang-{2} and llvm-spirv-{2} (tools/setup --gpu), "
                        "or omit --il",
                        operation, arguments[0], llvm_version()));
    if (status != 0)
        throw DeviceError(fmt::format("{}: {} ended with {}\n  options: {}\n  build log:\n{}", operation, arguments[0],
                                      ending_text(status), fmt::join(arguments, " "), log));
}

// Returns the source as SPIR-V. Compiles without optimisation, because of defects of llvm-spirv
// (docs/porting.md); the driver optimises. The version is 1.0; with -g, which needs it, 1.1.
std::string compiled_to_spirv(const std::string& source, const std::string& options, cl_uint address_bits,
                              const std::string& operation) {
    const TemporaryFolder folder("raya-spirv");
    const std::string text = folder / "kernel.cl", bitcode = folder / "kernel.bc", spirv = folder / "kernel.spv";
    write_whole_file(text, source);
    std::vector<std::string> clang = {std::string("clang-") + llvm_version(),
                                      "-target",
                                      address_bits == 32 ? "spir" : "spir64",
                                      "-O2",
                                      "-Xclang",
                                      "-disable-llvm-passes",
                                      "-emit-llvm",
                                      "-c",
                                      "-o",
                                      bitcode,
                                      text};
    std::istringstream words(options);
    for (std::string word; words >> word;) clang.push_back(word);
    run_compiler(clang, operation);
    run_compiler({std::string("llvm-spirv-") + llvm_version(), "--spirv-max-version=1.1", "-o", spirv, bitcode},
                 operation);
    return read_file(spirv);
}

}  // namespace

bool remove_il_option(std::string& options) {
    const std::string others = std::regex_replace(options, std::regex(" ?\\B--il\\b"), "");
    return std::exchange(options, others) != others;
}

void use_il() {
    const std::string options = user_build_options();
    ::setenv("RAYA_BUILD_OPTIONS", (options + (options.empty() ? "" : " ") + kIlOption).c_str(), 1);
}

bool uses_il() {
    std::string options = user_build_options();
    return remove_il_option(options);
}

std::string il_versions(const cl::Device& device) {
    std::array<char, 4096> versions{};  // devices without the extension cl_khr_il_program return an error
    const cl_int code =
        ::clGetDeviceInfo(device(), CL_DEVICE_IL_VERSION_KHR, versions.size() - 1, versions.data(), nullptr);
    return code == CL_SUCCESS ? versions.data() : "";
}

cl::Program spirv_program(const cl::Context& context, const cl::Device& device, const std::string& source,
                          const std::string& options, const std::string& operation) {
    const cl_platform_id platform = cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>())();
    void* create = nullptr;
    if (!il_versions(device).empty())
        for (const char* function : {"clCreateProgramWithILKHR", "clCreateProgramWithIL"})
            if (create == nullptr) create = ::clGetExtensionFunctionAddressForPlatform(platform, function);
    if (create == nullptr)
        throw DeviceError(fmt::format("{}: {} does not accept SPIR-V; remedy: omit --il, or choose another device",
                                      operation, device.getInfo<CL_DEVICE_NAME>()));
    const std::string spirv = compiled_to_spirv(source, options, device.getInfo<CL_DEVICE_ADDRESS_BITS>(), operation);
    cl_int error = CL_SUCCESS;
    const cl_program program =
        reinterpret_cast<decltype(&::clCreateProgramWithILKHR)>(create)(context(), spirv.data(), spirv.size(), &error);
    if (error != CL_SUCCESS) throw cl::Error(error, "clCreateProgramWithIL");
    return cl::Program(program);
}

}  // namespace raya
