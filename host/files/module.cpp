#include "host/files/module.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <array>
#include <filesystem>

namespace raya {
namespace fs = std::filesystem;
namespace {

fs::path find_module(const std::string& file) {
    std::error_code failure;
    const fs::path program = fs::read_symlink("/proc/self/exe", failure).parent_path();
    // The last is where the build leaves them for programs of tests, in folders below.
    const std::array<fs::path, 3> folders = {program, program / "../lib/raya", program / ".."};
    for (const fs::path& folder : folders)
        if (fs::exists(folder / file, failure)) return folder / file;
    throw ModuleError(
        fmt::format("{} lies neither beside the program nor in {}", file, folders[1].lexically_normal().string()));
}

std::string loader_error() {
    const char* told = ::dlerror();
    return told != nullptr ? told : "the loader gives no reason";
}

}  // namespace

void* module_function(const std::string& name, const char* symbol) {
    const fs::path file = find_module(name + ".so");
    // Lazily: a module's libraries have far more functions than are called.
    void* const module = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) throw ModuleNeeds(loader_error());
    void* const function = ::dlsym(module, symbol);
    if (function == nullptr) throw ModuleError(loader_error());
    return function;
}

}  // namespace raya
