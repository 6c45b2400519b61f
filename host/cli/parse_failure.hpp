// The words of a command line, and what is said of those that the option parser does not take: one line.
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace raya {

/// Parses the words behind the program's name and runs the command. What is not taken is a UserError, of one line; help
/// and version are a CLI::ParseError.
void parse_words(CLI::App& program, const std::vector<std::string>& arguments);

/// The names of a command's own commands.
std::vector<std::string> command_names(const CLI::App& command);

}  // namespace raya
