// Conversion of CLI11's commands and options to CommandText, and the help formatter of the parser.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// Formats help with help_text(), in the terminal's width. Stores the examples and the short help of each command.
class HelpFormatter : public CLI::FormatterBase {
  public:
    /// `path`: the command with its parents, "raya generate balls". Returns the short help if the command has one and
    /// `mode` is not All, otherwise the full help.
    std::string make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const override;

    std::map<const CLI::App*, std::vector<ExampleText>> examples{};  // of each command
};

/// Sets the command's examples: shell commands for a user in the folder that contains scenes/. Requires that the
/// program's formatter is a HelpFormatter.
void add_examples(CLI::App& command, std::vector<ExampleText> examples);

/// Converts an option of the parser to OptionText.
OptionText option_text(CLI::Option& option);

/// Converts a command with all its subcommands to CommandText, without hidden options and commands.
CommandText command_text(const CLI::App& command);

}  // namespace raya
