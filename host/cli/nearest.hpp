// Suggestions for misspelt names.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// Returns the name in `names` that is most similar to `word`: a name that begins with `word`, if `word` has 3 or more
/// characters; otherwise the name with the smallest edit distance (insertions, deletions, substitutions, transpositions
/// of neighbours; F. J. Damerau 1964). Returns "" if the smallest distance exceeds a third of the word's length.
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

/// Returns " (did you mean NAME?)" with nearest_name(), or "" if no name is similar.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);

}  // namespace raya
