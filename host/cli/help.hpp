// Help of the commands: the formatter of the parser.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace raya {

inline constexpr const char* kGeneralOptions = "General options";  // group that every command has; listed last

/// A shell command and its description.
struct ExampleText {
    std::string command{};  // "raya render scenes/centre.nff -o centre.png"
    std::string description{};
};

/// Formats help in 80 columns: usage, summary, examples, commands, options by group, exit codes. A command with a short
/// help, see has_short_help(), has in --help only the options with a brief text and the general options.
class HelpFormatter : public CLI::FormatterBase {
  public:
    std::string make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const override;

    std::map<const CLI::App*, std::vector<ExampleText>> examples{};  // of each command
};

/// Sets the command's examples: shell commands for a user in the folder that contains scenes/. Requires that the
/// program's formatter is a HelpFormatter.
void add_examples(CLI::App& command, std::vector<ExampleText> examples);

/// Returns the options and arguments that help lists, in the order of their groups; the general options are the last.
std::vector<const CLI::Option*> listed_options(const CLI::App& command);

/// Returns true if several of the command's options have a brief text. Some options are of many commands.
bool has_short_help(const CLI::App& command);

}  // namespace raya
