// Shell quoting, for commands in pages and messages.
#pragma once
#include <string>

namespace raya {

/// Returns the argument in single quotes, or unchanged if no shell interprets any of its characters.
std::string quoted(const std::string& argument);

}  // namespace raya
