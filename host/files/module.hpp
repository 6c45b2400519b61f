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

/// The function `symbol` of the module `name` (a file NAME.so), which stays loaded. It is looked for beside the
/// program, in ../lib/raya/ and .. from there. Throws ModuleError.
void* module_function(const std::string& name, const char* symbol);

}  // namespace raya
