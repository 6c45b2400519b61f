// Parts of the program that are loaded when they are first needed, so that a start does not pay for their libraries.
#pragma once
#include <stdexcept>
#include <string>

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

/// The function `symbol` of the module `name` (a file NAME.so), which stays loaded. It is looked for beside the
/// program, in ../lib/raya/ and .. from there. Throws ModuleError; UserError where a limit on
/// memory is in the way.
void* module_function(const std::string& name, const char* symbol);

}  // namespace raya
