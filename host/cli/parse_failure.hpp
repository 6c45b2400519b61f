// Parses the command line with one-line error messages.
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace raya {

/// Parses the arguments (without the program's name) and runs the command. Throws UserError with one line for a bad
/// argument, CLI::ParseError for --help and --version.
void parse_arguments(CLI::App& program, const std::vector<std::string>& arguments);

/// The names of a command's subcommands.
std::vector<std::string> command_names(const CLI::App& command);

}  // namespace raya
