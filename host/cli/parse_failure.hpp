// Parsing of the command line, with error messages of one line.
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace raya {

/// Parses the arguments (without the program's name) and runs the command. Throws UserError with a message of one line
/// for a bad argument. Throws CLI::ParseError, with exit code 0, for --help and --version.
void parse_arguments(CLI::App& program, const std::vector<std::string>& arguments);

/// Returns the names of a command's subcommands.
std::vector<std::string> command_names(const CLI::App& command);

}  // namespace raya
