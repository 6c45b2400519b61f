#include "host/base/module.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <grp.h>
#include <pwd.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>

#include "host/error.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

fs::path own_file;  // of set_own_file(); empty: the program, /proc/self/exe

std::string user_name(uid_t user) {
    const passwd* const entry = ::getpwuid(user);
    return entry != nullptr ? entry->pw_name : std::to_string(user);
}

bool has_other_members(gid_t group, uid_t owner) {
    const std::string name = user_name(owner);
    const ::group* const entry = ::getgrgid(group);
    for (char** member = entry != nullptr ? entry->gr_mem : nullptr; member != nullptr && *member != nullptr; ++member)
        if (*member != name) return true;
    bool found = false;
    ::setpwent();
    while (const passwd* const user = ::getpwent())
        found = found || (user->pw_gid == group && user->pw_uid != owner && user->pw_uid != 0);
    ::endpwent();
    return found;
}

std::string other_writers_of_one(const fs::path& path, const std::vector<uid_t>& owners, Sticky sticky) {
    struct stat is {
    }, root{};
    if (::lstat(path.c_str(), &is) != 0 || ::stat("/", &root) != 0)
        return fmt::format("'{}': {}", path.string(), std::generic_category().message(errno));
    // In a user namespace root may have another uid than 0, so the owner of "/" is also accepted as root.
    const bool by_root = is.st_uid == 0 || is.st_uid == root.st_uid;
    if (!by_root && std::find(owners.begin(), owners.end(), is.st_uid) == owners.end())
        return fmt::format("'{}' belongs to user {}", path.string(), user_name(is.st_uid));
    if (sticky == Sticky::kAllowed && (is.st_mode & S_ISVTX) != 0) return {};
    // If the file has an access control list, the group bits are the mask of all its entries, not the group's rights.
    const bool listed = ::lgetxattr(path.c_str(), "system.posix_acl_access", nullptr, 0) > 0;
    const bool by_group = (is.st_mode & S_IWGRP) != 0 && (listed || has_other_members(is.st_gid, is.st_uid));
    if (!by_group && (is.st_mode & S_IWOTH) == 0) return {};
    return fmt::format("other users may write '{}' (mode {:04o})", path.string(), is.st_mode & ALLPERMS);
}

bool is_within(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

struct OwnFile {
    fs::path folder;  // of the program
    uid_t owner;
};

OwnFile own_file_now() {
    std::error_code failure;
    const fs::path self = own_file.empty() ? "/proc/self/exe" : own_file;
    const fs::path folder = (own_file.empty() ? fs::read_symlink(self, failure) : own_file).parent_path();
    struct stat is {};
    if (failure || ::stat(self.c_str(), &is) != 0) throw ModuleError(fmt::format("cannot read {}", self.string()));
    return {folder, is.st_uid};
}

/// Returns the path of the module file `name`. Throws ModuleError if there is no such file, and UserError if another
/// user may change it: then loading it would not be safe.
fs::path checked_module(const std::string& name) {
    const fs::path file = module_folder() / name;
    std::error_code failure;
    if (!fs::is_regular_file(fs::symlink_status(file, failure)))
        throw ModuleError(fmt::format("there is no file '{}'", file.string()));
    const std::string why = other_writers_reason(file);
    if (why.empty()) return file;
    throw UserError(
        fmt::format("refused to load '{}': {}; remedy: chmod go-w, or install raya as root", file.string(), why));
}

std::string loader_error() {
    const char* text = ::dlerror();
    return text != nullptr ? text : "dlerror() gives no reason";
}

[[noreturn]] void refuse_to_load(const std::string& name) {
    const std::string reason = loader_error(), limit = memory_limit();
    const auto reason_has = [&](const char* part) { return reason.find(part) != reason.npos; };
    // dlerror() returns only a text. This text also appears if the file system is mounted noexec, so raya takes it for
    // a lack of memory only if there is a memory limit.
    if (!limit.empty() && reason_has("failed to map segment"))
        throw UserError(fmt::format("out of memory while loading {}.so: {}; remedy: raise {}", name, reason, limit));
    if (reason_has("failed to map segment")) throw ModuleError(reason);
    throw MissingLibrary(reason);
}

}  // namespace

std::string memory_limit() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
    return fmt::format("the limit of {} MB on memory (ulimit -v)", limit.rlim_cur >> 20);
}

void set_own_file(const fs::path& file) { own_file = file; }

fs::path module_folder() {
    const fs::path program = own_file_now().folder;
    std::error_code failure;
    return fs::weakly_canonical(program.filename() == "bin" ? program.parent_path() / "lib/raya" : program, failure);
}

std::string other_writers_reason(const fs::path& file) {
    const OwnFile own = own_file_now();
    // Folders above the program are not checked, because a user who may change them could replace the program itself.
    std::string why = other_writers(file.parent_path(), {::geteuid(), own.owner}, Sticky::kRefused, own.folder);
    if (why.empty()) why = other_writers_of_one(file, {::geteuid(), own.owner}, Sticky::kRefused);
    return why;
}

void* module_function(const std::string& name, const char* symbol) {
    const fs::path file = checked_module(name + ".so");
    // RTLD_LAZY, because most functions of a module's libraries are never called.
    void* const module = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) refuse_to_load(name);
    void* const function = ::dlsym(module, symbol);
    if (function == nullptr) throw ModuleError(loader_error());
    return function;
}

std::string other_writers(fs::path path, const std::vector<uid_t>& owners, Sticky sticky, const fs::path& known) {
    std::string why = other_writers_of_one(path, owners, sticky);
    for (path = path.parent_path(); why.empty() && !is_within(known, path); path = path.parent_path())
        why = other_writers_of_one(path, owners, Sticky::kAllowed);
    return why;
}

}  // namespace raya
