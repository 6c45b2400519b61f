// Parts of the program that are loaded when they are first needed, so that a start does not pay for their libraries;
// and who may change files with code.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace raya {

/// A module is not there, or does not load: the message names it, and the loader's reason.
struct ModuleError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// It is there, but not what it needs: a library that may be installed.
struct ModuleNeeds : ModuleError {
    using ModuleError::ModuleError;
};

/// "the limit of 488 MB on memory (ulimit -v)", under which libraries may not load; empty where there is none.
std::string memory_limit();

/// The function `symbol` of the module `name` (a file NAME.so), which stays loaded. A program in a folder `bin` has its
/// modules in ../lib/raya from there, any other in its own folder. ModuleError; UserError where users other than root,
/// this one and the program's owner may change the file or its folder, or a limit on memory is in the way.
void* module_function(const std::string& name, const char* symbol);

/// Where modules lie, and what else came with the program. ModuleError.
std::filesystem::path module_folder();

/// Why users other than root, this one and the program's owner may change this file, or a folder between it and the
/// program's; empty where they may not.
std::string writers_besides_owner(const std::filesystem::path& file);

/// For what is no program of its own, the Python module, and for tests: the file from which modules are found.
void set_own_file(const std::filesystem::path& file);

/// Whether a folder that anybody may write passes if it is sticky: nobody may replace what others own there.
enum class Sticky { kRefused, kAllowed };

/// Why users other than root and `owners` may change `path`, an absolute one without links, or replace it: names the
/// file or folder with its owner or mode; empty where they may not. A group passes if it has no member but the owner.
/// Folders above may be sticky; those above `known` as well are not checked.
std::string other_writers(std::filesystem::path path, const std::vector<uid_t>& owners, Sticky sticky,
                          const std::filesystem::path& known = "/");

}  // namespace raya
