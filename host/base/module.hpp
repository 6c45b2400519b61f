// Modules: shared objects that are loaded on first use, so that other runs do not pay for their libraries. Also checks
// that no other user may change files with code.
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

/// Returns the function `symbol` of the module `name` (a file NAME.so), which stays loaded. The modules of a program in
/// a folder `bin` are in ../lib/raya; those of any other program are in its own folder. Throws ModuleError, and
/// UserError if users other than root, this user and the program's owner may change the file or its folder, or if a
/// memory limit prevents loading.
void* module_function(const std::string& name, const char* symbol);

/// The folder of the modules and of the other files installed with the program. ModuleError.
std::filesystem::path module_folder();

/// Returns why users other than root, this user and the program's owner may change this file or a folder between it and
/// the program's; empty if they may not.
std::string other_writers_reason(const std::filesystem::path& file);

/// Sets the file whose folder determines module_folder(), instead of the program: for the Python module and tests.
void set_own_file(const std::filesystem::path& file);

/// Whether a world-writable folder is accepted if it is sticky: users cannot replace files of others there.
enum class Sticky { kRefused, kAllowed };

/// Returns why users other than root and `owners` may change or replace `path` (absolute, without links), with the file
/// or folder and its owner or mode; empty if they may not. A writable group is accepted if the owner is its only
/// member. Folders above `path` may be sticky. Folders that also contain `known` are not checked.
std::string other_writers(std::filesystem::path path, const std::vector<uid_t>& owners, Sticky sticky,
                          const std::filesystem::path& known = "/");

}  // namespace raya
