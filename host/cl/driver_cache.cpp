#include "host/cl/driver_cache.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "host/files/verbosity.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// Whether the folder can be made, or written where it is there.
bool can_be_had(fs::path folder) {
    std::error_code error;
    while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    return ::access(folder.c_str(), W_OK | X_OK) == 0;
}

}  // namespace

void provide_driver_cache() {
    const std::string home = variable("HOME"), cache = variable("XDG_CACHE_HOME");
    if (!variable("POCL_CACHE_DIR").empty() || (home.empty() && cache.empty())) return;
    const fs::path usual = (cache.empty() ? fs::path(home) / ".cache" : fs::path(cache)) / "pocl";
    if (can_be_had(usual)) return;
    std::error_code error;
    const fs::path own = fs::temp_directory_path(error) / fmt::format("raya-pocl-cache-{}", ::geteuid());
    fs::create_directory(own, error);
    fs::permissions(own, fs::perms::owner_all, error);
    if (error || ::access(own.c_str(), W_OK | X_OK) != 0) return;
    ::setenv("POCL_CACHE_DIR", own.c_str(), 1);
    warn(fmt::format("warning: {} is not writable: PoCL keeps its kernels in {}; POCL_CACHE_DIR names another place",
                     usual.string(), own.string()));
}

}  // namespace raya
