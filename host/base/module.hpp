// Modules: shared libraries that raya loads on first use. A run that does not use a module does not load the libraries
// that the module needs. Also checks that no other user may change files with code. "The program" is raya's executable.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace raya {

/// Thrown if a module is missing or does not load. The message names the module and gives the loader's reason.
struct ModuleError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Thrown if the module exists, but a library that it needs is not installed.
struct MissingLibrary : ModuleError {
    using ModuleError::ModuleError;
};

/// Returns "the limit of 488 MB on memory (ulimit -v)"; empty if there is no limit. A limit may prevent libraries from
/// loading.
std::string memory_limit();

/// Returns the function `symbol` of the module `name` (module_file("NAME.so")). The module stays loaded.
/// Throws ModuleError if the module does not load or has no such function. Throws UserError if users other than root,
/// this user and the program's owner may change the file or its folder, or if a memory limit prevents loading.
void* module_function(const std::string& name, const char* symbol);

/// Returns the path of the file `name`, a module or a program that raya runs. It is in ../lib/raya if the program's
/// folder is named `bin`, else in the program's folder. Throws ModuleError if there is no such file. Throws UserError
/// if users other than root, this user and the program's owner may change the file or its folder.
std::filesystem::path module_file(const std::string& name);

/// Makes module_file() use the path of `file` instead of the program's. For the Python module and tests.
void set_program_file(const std::filesystem::path& file);

/// kAllowed: accept a folder that other users may write if its sticky bit is set. The bit prevents users from replacing
/// other users' files in the folder.
enum class Sticky { kRefused, kAllowed };

/// Checks if users other than root and `owners` may change or replace `path` (absolute, without symbolic links).
/// Returns the reason if they may (file or folder, and its owner or mode), else an empty string. Accepts a group
/// with write permission if the owner is its only member. `sticky` applies to `path`; folders above may be sticky. Does
/// not check folders that contain the folder `trusted`.
std::string unsafe_path_reason(std::filesystem::path path, const std::vector<uid_t>& owners, Sticky sticky,
                               const std::filesystem::path& trusted = "/");

}  // namespace raya
