#include "host/files/module.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <sys/resource.h>

#include <array>
#include <filesystem>

#include "host/error.hpp"

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

[[noreturn]] void refuse_to_load(const std::string& name) {
    const std::string reason = loader_error(), limit = memory_limit();
    const auto reason_has = [&](const char* part) { return reason.find(part) != reason.npos; };
    // The loader's words, which have no error code, are the same for a file system that is mounted with noexec.
    if (!limit.empty() && reason_has("failed to map segment"))
        throw UserError(fmt::format("out of memory while loading {}.so: {}; remedy: raise {}", name, reason, limit));
    if (reason_has("failed to map segment")) throw ModuleError(reason);
    throw ModuleNeeds(reason);
}

}  // namespace

std::string memory_limit() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
    return fmt::format("the limit of {} MB on memory (ulimit -v)", limit.rlim_cur >> 20);
}

void* module_function(const std::string& name, const char* symbol) {
    const fs::path file = find_module(name + ".so");
    // Lazily: a module's libraries have far more functions than are called.
    void* const module = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) refuse_to_load(name);
    void* const function = ::dlsym(module, symbol);
    if (function == nullptr) throw ModuleError(loader_error());
    return function;
}

}  // namespace raya
