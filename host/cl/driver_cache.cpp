#include "host/cl/driver_cache.hpp"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "host/base/module.hpp"
#include "host/base/verbosity.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

constexpr const char* kVariable = "POCL_CACHE_DIR";

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// What PoCL takes unless POCL_CACHE_DIR names another one.
fs::path usual_folder() {
    const std::string home = variable("HOME"), cache = variable("XDG_CACHE_HOME");
    if (!cache.empty()) return fs::path(cache) / "pocl/kcache";
    return home.empty() ? "/tmp/pocl/kcache" : fs::path(home) / ".cache/pocl/kcache";
}

/// Why PoCL's cache must not be this folder, or be made below what there is of its path; empty if it may.
std::string unsafe(fs::path folder) {
    std::error_code error;
    while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    if (::access(folder.c_str(), W_OK | X_OK) != 0) return fmt::format("'{}' is not writable", folder.string());
    return other_writers(folder, {::geteuid()}, Sticky::kRefused);
}

/// Makes a folder for this user alone, unless it is there and is such a one. Others may have made it.
bool is_own(const fs::path& folder) {
    struct stat is {};
    ::mkdir(folder.c_str(), S_IRWXU);
    return ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
           (is.st_mode & ACCESSPERMS) == S_IRWXU;
}

fs::path own_folder(const std::string& why) {
    std::error_code error;
    fs::path temporary = fs::canonical(fs::temp_directory_path(error), error);
    if (error) temporary = "/tmp";
    const std::string first = temporary / fmt::format("raya-pocl-cache-{}", ::geteuid());
    if (other_writers(temporary, {::geteuid()}, Sticky::kAllowed).empty())
        for (const char* end : {"", "-1", "-2", "-3", "-4", "-5", "-6", "-7", "-8", "-9"})
            if (is_own(first + end)) return first + end;
    throw DeviceError(
        fmt::format("no folder for PoCL's kernels: {}, and neither '{}' nor one with -1 to -9 behind that is a folder "
                    "of this user alone; name one in POCL_CACHE_DIR",
                    why, first));
}

}  // namespace

void provide_driver_cache() {
    if (!variable(kVariable).empty()) return;
    std::error_code error;
    const fs::path usual = fs::weakly_canonical(fs::absolute(usual_folder(), error), error);
    const std::string why = error ? fmt::format("'{}': {}", usual_folder().string(), error.message()) : unsafe(usual);
    // PoCL gets the path that was checked: what links lead to may change.
    const fs::path chosen = why.empty() ? usual : own_folder(why);
    ::setenv(kVariable, chosen.c_str(), 1);
    if (!why.empty())
        warn(fmt::format("warning: {}: PoCL keeps its kernels in {}; POCL_CACHE_DIR names another folder", why,
                         chosen.string()));
}

std::string driver_cache_trouble() {
    constexpr std::size_t kEnough = 1 << 20;  // bytes: a kernel takes less
    const fs::path folder = variable(kVariable), probe = folder / fmt::format("raya-{}", ::getpid());
    try {
        std::error_code error;
        fs::create_directories(folder, error);
        write_whole_file(probe, std::string(kEnough, 'x'));
        fs::remove(probe, error);
        return {};
    } catch (const UserError& error) {
        return fmt::format("PoCL's kernel cache (POCL_CACHE_DIR={}): {}", folder.string(), error.what());
    }
}

}  // namespace raya
