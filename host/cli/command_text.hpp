// Commands and options as plain text, the source of help, manual pages and shell completions.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace raya {

/// An option or a positional argument.
struct OptionText {
    std::vector<std::string> names{};    // "-o", "--output"; or "SCENE" for a positional argument
    std::string placeholder{};           // stands for the value in help: "FILE.json", "N|WxH"; empty: a flag
    std::string default_value{};         // empty: no default, or `help` contains the default
    std::string help{};                  // full help text
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

/// An option in the short help of a command.
struct ShortHelp {
    std::string name{};   // "--size"
    std::string group{};  // heading above the option in the short help
    std::string help{};   // replaces the full help text unless empty
};

struct CommandText {
    std::string name{};  // "render"; "raya" for the program itself
    std::string summary{};
    std::vector<ExampleText> examples{};
    std::string footer{};                 // paragraphs, which may begin with "Title: " or with a line "Title:"
    std::vector<OptionText> arguments{};  // positional arguments, in order
    std::vector<OptionText> options{};
    std::vector<CommandText> commands{};
    std::vector<ShortHelp> short_help{};  // options that --help shows; empty: all options
};

/// How shells complete an option's value.
struct ValueCompletion {
    enum class Kind { kOther, kChoice, kList, kFile, kFolder } kind = Kind::kOther;  // kOther: no candidates
    std::vector<std::string> choices{};  // kChoice: the value is one of them; kList: several of them, comma-separated
    std::vector<std::string> extensions{};  // kFile: extensions of the files, ".json"; empty: any
};

/// Returns how shells complete the option's value. Uses the option's choices or, if there are none, the placeholder of
/// its value: "ring|bus" is a choice, "none,grid" a list; FILE.json, SCENE and IMAGE are files, DIR is a folder.
ValueCompletion value_completion(const OptionText& option);

/// Returns the option's help and default; if the help is empty, the placeholder of its value.
std::string description_of(const OptionText& option);

/// Returns the headings of a command's options, in order of first use.
std::vector<std::string> groups_of(const CommandText& command);

/// Returns the text before the first "; ", ". " or line break, cut to `max_characters` characters.
std::string brief(const std::string& help, std::size_t max_characters = 72);

/// Calls `each(command, path)` for `command` and all its subcommands at any depth, parents first. A path is, for
/// example, "raya generate balls".
template <class Each>
void for_each_command(const CommandText& command, const Each& each, const std::string& parent_path = "") {
    const std::string path = parent_path.empty() ? command.name : parent_path + ' ' + command.name;
    each(command, path);
    for (const CommandText& subcommand : command.commands) for_each_command(subcommand, each, path);
}

/// Returns the help of a command: usage, summary, examples, commands, options by group, footer. `path`: the command
/// with its parents, "raya generate balls". Lines have at most `width` characters, except for a longer single word.
std::string help_text(const CommandText& command, const std::string& path, std::size_t width);

/// Returns `command` with only the options of its short help, and with a footer that mentions --help-all. Returns
/// `command` unchanged if it has no short help. Throws std::logic_error if the short help names an option that does not
/// exist.
CommandText short_form(CommandText command, const std::string& path);

/// A manual page (section 1) of the program, or of one of its commands with all subcommands.
struct ManPage {
    std::string name{};  // "raya", "raya-render"
    std::string text{};  // troff source with man macros
};

/// Returns the pages of the program and of each of its commands. The pages list all options.
std::vector<ManPage> man_pages(const CommandText& program, const std::string& name_and_version);

}  // namespace raya
