// Suggestions for misspelt names.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// The name nearest to `word`: one that begins with it, else the one with the smallest edit distance (insertions,
/// deletions, substitutions, swaps of neighbours; F. J. Damerau 1964) up to a third of the word's length. Else "".
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

/// " (did you mean NAME?)", or nothing.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);

}  // namespace raya
