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

fs::path substitute_file;  // set by set_program_file(); empty: raya's executable, /proc/self/exe

std::string user_name(uid_t user) {
    const passwd* const entry = ::getpwuid(user);
    return entry != nullptr ? entry->pw_name : std::to_string(user);
}

/// Returns true if a user other than `owner` and root is a member of the group, or if the group has no name here.
bool has_other_members(gid_t group, uid_t owner) {
    const std::string name = user_name(owner);
    const ::group* const entry = ::getgrgid(group);
    if (entry == nullptr) return true;
    for (char** member = entry->gr_mem; *member != nullptr; ++member)
        if (*member != name) return true;
    bool has_other = false;
    ::setpwent();
    while (const passwd* const user = ::getpwent())
        has_other = has_other || (user->pw_gid == group && user->pw_uid != owner && user->pw_uid != 0);
    ::endpwent();
    return has_other;
}

std::string unsafe_entry_reason(const fs::path& path, const std::vector<uid_t>& owners, Sticky sticky) {
    struct stat status {
    }, root{};
    if (::lstat(path.c_str(), &status) != 0 || ::stat("/", &root) != 0)
        return fmt::format("'{}': {}", path.string(), std::generic_category().message(errno));
    // In a user namespace root may have another uid than 0, so the owner of "/" is also accepted as root.
    const bool is_owned_by_root = status.st_uid == 0 || status.st_uid == root.st_uid;
    if (!is_owned_by_root && std::find(owners.begin(), owners.end(), status.st_uid) == owners.end())
        return fmt::format("'{}' belongs to user {}", path.string(), user_name(status.st_uid));
    if (sticky == Sticky::kAllowed && (status.st_mode & S_ISVTX) != 0) return {};
    // If the file has an access control list, the group bits are the mask of all its entries, not the group's rights.
    const bool has_access_list = ::lgetxattr(path.c_str(), "system.posix_acl_access", nullptr, 0) > 0;
    const bool group_may_write =
        (status.st_mode & S_IWGRP) != 0 && (has_access_list || has_other_members(status.st_gid, status.st_uid));
    if (!group_may_write && (status.st_mode & S_IWOTH) == 0) return {};
    return fmt::format("other users may write '{}' (mode {:04o})", path.string(), status.st_mode & ALLPERMS);
}

bool is_within(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::string loader_error() {
    const char* text = ::dlerror();
    return text != nullptr ? text : "dlerror() gives no reason";
}

[[noreturn]] void refuse_to_load(const std::string& name) {
    const std::string reason = loader_error(), limit = memory_limit();
    const auto reason_has = [&](const char* part) { return reason.find(part) != reason.npos; };
    // The text "failed to map segment" also appears if the file system is mounted noexec. raya therefore reports a lack
    // of memory only if there is a memory limit.
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

void set_program_file(const fs::path& file) { substitute_file = file; }

fs::path module_file(const std::string& name) {
    std::error_code failure;
    const fs::path self = substitute_file.empty() ? "/proc/self/exe" : substitute_file;
    const fs::path program = (substitute_file.empty() ? fs::read_symlink(self, failure) : self).parent_path();
    struct stat status {};
    if (failure || ::stat(self.c_str(), &status) != 0) throw ModuleError(fmt::format("cannot read {}", self.string()));
    const fs::path folder = program.filename() == "bin" ? program.parent_path() / "lib/raya" : program;
    const fs::path file = fs::weakly_canonical(folder, failure) / name;
    if (!fs::is_regular_file(fs::symlink_status(file, failure)))
        throw ModuleError(fmt::format("there is no file '{}'", file.string()));
    const std::vector<uid_t> owners = {::geteuid(), status.st_uid};
    // Folders above the program are not checked, because a user who may change them could replace the program itself.
    std::string reason = unsafe_path_reason(file.parent_path(), owners, Sticky::kRefused, program);
    if (reason.empty()) reason = unsafe_entry_reason(file, owners, Sticky::kRefused);
    if (reason.empty()) return file;
    throw UserError(
        fmt::format("refused to load '{}': {}; remedy: chmod go-w, or install raya as root", file.string(), reason));
}

void* module_function(const std::string& name, const char* symbol) {
    const fs::path file = module_file(name + ".so");
    // RTLD_LAZY, because most functions of a module's libraries are never called.
    void* const module = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) refuse_to_load(name);
    void* const function = ::dlsym(module, symbol);
    if (function == nullptr) throw ModuleError(loader_error());
    return function;
}

std::string unsafe_path_reason(fs::path path, const std::vector<uid_t>& owners, Sticky sticky,
                               const fs::path& trusted) {
    std::string reason = unsafe_entry_reason(path, owners, sticky);
    for (path = path.parent_path(); reason.empty() && !is_within(trusted, path); path = path.parent_path())
        reason = unsafe_entry_reason(path, owners, Sticky::kAllowed);
    return reason;
}

}  // namespace raya
