// Parsing of the command line, with error messages of one line.
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace raya {

// Suggestions for misspelt names.

/// Returns the name in `names` that begins with `misspelling`, if `misspelling` has 3 or more characters. Otherwise
/// returns the name with the smallest edit distance (insertions, deletions, substitutions, transpositions of
/// neighbours; F. J. Damerau 1964), or "" if this distance exceeds a third of the length of `misspelling`.
std::string nearest_name(const std::string& misspelling, const std::vector<std::string>& names);

/// Returns " (did you mean NAME?)" with the name that nearest_name() returns; "" if no name is similar.
std::string did_you_mean(const std::string& misspelling, const std::vector<std::string>& names);

/// Parses the arguments (without the program's name) and runs the command. Throws UserError with a message of one line
/// for a bad argument. Throws CLI::ParseError, with exit code 0, for --help and --version.
void parse_arguments(CLI::App& program, const std::vector<std::string>& arguments);

/// Returns the names of a command's subcommands.
std::vector<std::string> command_names(const CLI::App& command);

}  // namespace raya
