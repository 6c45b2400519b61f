// Words of a command line, for pages and messages that say how to repeat something.
#pragma once
#include <string>

namespace raya {

/// The word as a shell takes it: in quotes where it has more than letters, digits and what is harmless.
std::string quoted(const std::string& word);

}  // namespace raya
