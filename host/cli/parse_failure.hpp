// What is said of a command line that the option parser does not take: one line, in raya's own words.
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace raya {

/// `arguments`: the words of the command line, in order.
std::string parse_failure_text(const CLI::App& program, const CLI::ParseError& error,
                               const std::vector<std::string>& arguments);

/// The names of a command's own commands.
std::vector<std::string> command_names(const CLI::App& command);

}  // namespace raya
