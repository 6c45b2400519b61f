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

    /// Texts of a command that CLI11 cannot store.
    struct Texts {
        std::vector<ExampleText> examples{};
        std::vector<ShortHelp> short_help{};
    };
    Texts& texts_of(const CLI::App& command) { return texts_[&command]; }
    /// Returns empty texts if none were stored for the command.
    Texts texts_of(const CLI::App& command) const;

  private:
    std::map<const CLI::App*, Texts> texts_;
};

/// Sets the command's examples: shell commands for a user in the folder that contains scenes/. Requires that the
/// program's formatter is a HelpFormatter.
void add_examples(CLI::App& command, std::vector<ExampleText> examples);

/// Adds --help-all, and makes --help show only `options`, in this order, followed by the general options. Requires
/// that the program's formatter is a HelpFormatter.
void add_short_help(CLI::App& command, std::vector<ShortHelp> options);

/// Converts an option of the parser to OptionText.
OptionText option_text(CLI::Option& option);

/// Converts the program with all its commands to CommandText, without hidden options and commands. The choices of a
/// positional argument COMMAND are the names of the program's commands.
CommandText command_text(const CLI::App& program);

}  // namespace raya
