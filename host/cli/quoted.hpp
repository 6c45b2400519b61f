// Shell quoting, for commands in pages and messages.
#pragma once
#include <string>

namespace raya {

/// The word for a shell: in single quotes unless all its letters are safe.
std::string quoted(const std::string& word);

}  // namespace raya
