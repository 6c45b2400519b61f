// Modules: shared objects that are loaded on first use, so that runs without them do not load their libraries. Also
// checks that no other user may change files that contain code.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace raya {

/// A module is missing or does not load. The message names it and gives the loader's reason.
struct ModuleError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The module exists, but a library that it needs is not installed.
struct MissingLibrary : ModuleError {
    using ModuleError::ModuleError;
};

/// "the limit of 488 MB on memory (ulimit -v)", under which libraries may fail to load; empty if there is no limit.
std::string memory_limit();

/// Returns the function `symbol` of the module `name` (the file NAME.so in module_folder()), which stays loaded. Throws
/// ModuleError, and UserError if users other than root, this user and the program's owner may change the file or its
/// folder, or if a memory limit prevents loading.
void* module_function(const std::string& name, const char* symbol);

/// The folder of the modules and of the other files installed with the program: ../lib/raya if the program's folder is
/// named `bin`, else the program's folder. Throws ModuleError if the program's path cannot be read.
std::filesystem::path module_folder();

/// Checks if users other than root, this user and the program's owner may change `file`, its folder, or a folder above
/// that does not contain the program. Returns the reason if they may, as other_writers(), else an empty string.
std::string other_writers_reason(const std::filesystem::path& file);

/// Makes module_folder() use the path of `file` instead of the program's. For the Python module and tests.
void set_own_file(const std::filesystem::path& file);

/// Treatment of a folder that others may write but that has the sticky bit, so that they cannot replace files in it
/// that belong to another user.
enum class Sticky { kRefused, kAllowed };

/// Checks if users other than root and `owners` may change or replace `path` (absolute, without symbolic links).
/// Returns the reason if they may: the file or folder, and its owner or mode; else an empty string. Accepts a group
/// with write permission if the owner is its only member. `sticky` applies to `path`; folders above may be sticky. Does
/// not check the folders above `path` that contain `known`.
std::string other_writers(std::filesystem::path path, const std::vector<uid_t>& owners, Sticky sticky,
                          const std::filesystem::path& known = "/");

}  // namespace raya
