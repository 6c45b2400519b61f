// The name that a user may have meant.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// Of `names` the one that `word` is most like: which begins with it, or which it becomes by the fewest letters put in,
/// left out, changed or swapped with their neighbour (F. J. Damerau 1964), a third of its letters at most. Empty: none
/// is like it.
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

/// " (did you mean NAME?)", or nothing.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);

}  // namespace raya
