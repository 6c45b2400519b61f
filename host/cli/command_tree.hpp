// Commands and options of the parser as plain text, and the parser's help formatter.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// Formats help from CommandText, as wide as the terminal. Stores what CLI11 has no field for: the examples and the
/// short help of each command.
class HelpFormatter : public CLI::FormatterBase {
  public:
    /// `path`: the command with its parents, "raya generate balls". The short help, if the command has one and `mode`
    /// is not All.
    std::string make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const override;

    struct Texts {
        std::vector<ExampleText> examples{};
        std::vector<ShortHelp> short_help{};
    };
    Texts& texts_of(const CLI::App& command) { return texts_[&command]; }
    /// Empty texts for an unknown command.
    Texts texts_of(const CLI::App& command) const;

  private:
    std::map<const CLI::App*, Texts> texts_;
};

/// Sets the command's examples: shell commands that run in the folder that contains scenes/. The command's program has
/// a HelpFormatter.
void add_examples(CLI::App& command, std::vector<ExampleText> examples);

/// Adds --help-all, and lets --help show these options only, in this order, followed by the general ones. The command's
/// program has a HelpFormatter.
void add_short_help(CLI::App& command, std::vector<ShortHelp> options);

/// An option of the parser as text.
OptionText option_text(CLI::Option& option);

/// The program with all its commands, without hidden options and commands. The choices of an argument COMMAND are the
/// names of the commands.
CommandText command_text(const CLI::App& program);

}  // namespace raya
