// Commands and options as plain text, from which help and manual pages are made.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace raya {

/// An option or a positional argument.
struct OptionText {
    std::vector<std::string> names{};    // "-o", "--output"; of a positional argument its name: "SCENE"
    std::string value{};                 // placeholder of the value: "FILE.json", "N|WxH"; empty: a flag
    std::string default_value{};         // as text; empty: no default, or `help` gives it
    std::string help{};                  //
    std::string group{};                 // its heading in help
    bool required = false;               //
    bool repeated = false;               // takes several values
    std::vector<std::string> choices{};  // legal values, as far as they can be listed

    bool is_flag() const { return value.empty(); }
    bool is_argument() const { return !names.front().starts_with('-'); }
};

/// A shell command, and what it does.
struct ExampleText {
    std::string command{};  // "raya render scenes/centre.nff -o centre.png"
    std::string description{};
};

/// An option in the short help of a command.
struct ShortHelp {
    std::string name{};   // "--size"
    std::string group{};  // its heading there
    std::string help{};   // empty: as in the full help
};

struct CommandText {
    std::string name{};  // "render", of the first "raya"
    std::string summary{};
    std::vector<ExampleText> examples{};
    std::string footer{};  // paragraphs; one that begins with "Title: " or with the line "Title:" has that title
    std::vector<OptionText> arguments{};  // positional, in their order
    std::vector<OptionText> options{};
    std::vector<CommandText> commands{};
    std::vector<ShortHelp> short_help{};  // the options that --help shows; empty: all
};

/// Shell completion of a value.
struct ValueText {
    enum class Kind { kOther, kChoice, kList, kFile, kFolder } kind = Kind::kOther;
    std::vector<std::string> choices{};  // of kChoice, and of kList: a comma-separated list of choices
    std::string extension{};             // of kFile: ".json", or empty for any
};

/// From the option's choices, else from its placeholder: "ring|bus" is a choice, "none,grid" a list, FILE.json,
/// SCENE.nff and IMAGE are files, DIR is a folder.
ValueText value_of(const OptionText& option);

/// The option's help with its default; without help its placeholder.
std::string description_of(const OptionText& option);

/// The headings of a command's options, in their order.
std::vector<std::string> groups_of(const CommandText& command);

/// The first sentence or clause of a help text, at most `max_letters` long.
std::string brief(const std::string& help, std::size_t max_letters = 72);

/// Calls `each` with every command and its path, "raya generate balls", parents first.
template <class Each>
void for_each_command(const CommandText& command, const Each& each, const std::string& before = "") {
    const std::string path = before.empty() ? command.name : before + ' ' + command.name;
    each(command, path);
    for (const CommandText& one : command.commands) for_each_command(one, each, path);
}

/// Help of the command with path `path`, "raya generate balls": usage, summary, examples, commands, options by group,
/// footer. No line is longer than `width` letters, unless a single word is.
std::string help_text(const CommandText& command, const std::string& path, std::size_t width);

/// `command` with the options of its short help only, and a footer that names --help-all. Unchanged without a short
/// help. Throws std::logic_error if the short help names an option that does not exist.
CommandText short_form(CommandText command, const std::string& path);

/// A page of section 1: "raya", or "raya-render" of one of its commands, with the commands below it.
struct ManPage {
    std::string name{};  // "raya-render"
    std::string text{};  // man macros
};

/// The pages of the program and of each of its commands. They list all options.
std::vector<ManPage> man_pages(const CommandText& program, const std::string& name_and_version);

}  // namespace raya
