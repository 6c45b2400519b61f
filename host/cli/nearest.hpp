// Suggestions for misspelt names.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// Returns the name in `names` that begins with `misspelling`, if `misspelling` has 3 or more characters. Otherwise
/// returns the name with the smallest edit distance (insertions, deletions, substitutions, transpositions of
/// neighbours; F. J. Damerau 1964), or "" if this distance exceeds a third of the length of `misspelling`.
std::string nearest_name(const std::string& misspelling, const std::vector<std::string>& names);

/// Returns " (did you mean NAME?)" with the name that nearest_name() returns; "" if no name is similar.
std::string did_you_mean(const std::string& misspelling, const std::vector<std::string>& names);

}  // namespace raya
