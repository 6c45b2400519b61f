// Help of the commands: their options as plain data, and the formatter of the parser.
#pragma once
#include <CLI/CLI.hpp>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace raya {

inline constexpr const char* kGeneralOptions = "General options";  // group that every command has; listed last

/// An option or a positional argument.
struct OptionText {
    std::vector<std::string> names{};    // "-o", "--output"; or "SCENE" for a positional argument
    std::string placeholder{};           // stands for the value in help: "FILE.json", "N|WxH"; empty: a flag
    std::string default_value{};         // empty: no default, or `help` contains the default
    std::string help{};                  // full help text
    std::string brief{};                 // text in the command's short help; empty: not there
    std::string group{};                 // heading above the option in help
    bool required = false;               // must be given
    bool repeated = false;               // may have several values
    std::vector<std::string> choices{};  // legal values; empty if there is no finite list

    bool is_flag() const { return placeholder.empty(); }
    bool is_argument() const { return !names.front().starts_with('-'); }
};

/// A shell command and its description.
struct ExampleText {
    std::string command{};  // "raya render scenes/centre.nff -o centre.png"
    std::string description{};
};

struct CommandText {
    std::string name{};  // "render"; "raya" for the program itself
    std::string summary{};
    std::vector<ExampleText> examples{};
    std::string footer{};                 // paragraphs, and lines "  NAME   description"
    std::vector<OptionText> arguments{};  // positional arguments, in order
    std::vector<OptionText> options{};
    std::vector<CommandText> commands{};
};

/// Returns the values of an option: its choices or, if there are none, those in the placeholder of its value,
/// "none|bvh|grid[:AxBxC]" or "none,grid". Empty if there is no finite list.
std::vector<std::string> choices_of(const OptionText& option);

/// Returns the headings of a command's options, in order of first use.
std::vector<std::string> groups_of(const CommandText& command);

/// Returns the help of a command: usage, summary, examples, commands, options by group, footer. `path`: the command
/// with its parents, "raya generate balls". Lines have at most `width` characters, except for a longer single word.
std::string help_text(const CommandText& command, const std::string& path, std::size_t width);

/// A command has a short help if at least this many options have a brief text: some options are of many commands.
inline constexpr std::ptrdiff_t kMinBriefOptions = 5;
bool has_short_form(const CommandText& command);

/// Returns `command` with only the options of its short help and the general options, and with a footer that mentions
/// --help-all. Returns `command` unchanged if it has no short help.
CommandText short_form(CommandText command, const std::string& path);

/// Formats help with help_text(), in the terminal's width. Stores the examples of each command.
class HelpFormatter : public CLI::FormatterBase {
  public:
    /// Returns the short help if the command has one and `mode` is not All, otherwise the full help.
    std::string make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const override;

    std::map<const CLI::App*, std::vector<ExampleText>> examples{};
};

/// Sets the command's examples: shell commands for a user in the folder that contains scenes/. Requires that the
/// program's formatter is a HelpFormatter.
void add_examples(CLI::App& command, std::vector<ExampleText> examples);

OptionText option_text(CLI::Option& option);

/// Converts a command with all its subcommands, without hidden options and commands.
CommandText command_text(const CLI::App& command);

}  // namespace raya
