// Commands and options as plain text, what --help prints of them for a terminal of any width, and manual pages.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace raya {

/// An option, or a word without one.
struct OptionText {
    std::vector<std::string> names{};  // "-o", "--output"; of a word without an option its name: "SCENE"
    std::string value{};               // what help calls the value, such as "FILE.json" or "N|WxH"; empty: a flag
    std::string usual{};               // the default, as text; empty: none, or the help says it
    std::string help{};
    std::string group{};               // the heading that it stands below in help
    bool required = false;             //
    bool repeated = false;             // takes several values
    std::vector<std::string> words{};  // that the value may be, as far as they can be listed

    bool is_flag() const { return value.empty(); }
    /// Stands alone, without an option.
    bool is_word() const { return !names.front().starts_with('-'); }
};

/// A line for a shell, and what it does.
struct ExampleText {
    std::string command{};  // "raya render scenes/centre.nff -o centre.png"
    std::string says{};
};

struct CommandText {
    std::string name{};  // "render", of the first "raya"
    std::string summary{};
    std::vector<ExampleText> examples{};
    std::string footer{};  // paragraphs; one that begins with "Title: " or "Title:" and a line's end has that title
    std::vector<OptionText> words{};  // without an option, in their order
    std::vector<OptionText> options{};
    std::vector<CommandText> commands{};
};

/// What a shell offers for a value.
struct ValueText {
    enum class Kind { kOther, kWords, kList, kFile, kFolder } kind = Kind::kOther;
    std::vector<std::string> words{};  // of kWords, and of kList, whose words stand side by side with commas
    std::string extension{};           // of kFile: ".json", or empty for any
};

/// From the words of the option; else from what help calls its value: "ring|bus", "none,grid" are lists of words,
/// FILE.json, SCENE.nff, IMAGE are files, DIR is a folder.
ValueText value_of(const OptionText& option);

/// What help says of an option, with its default; of one without help, what it calls its value.
std::string said_of(const OptionText& option);

/// The headings of a command's options, in their order.
std::vector<std::string> groups_of(const CommandText& command);

/// The first thing that help says, for a line beside a name: up to `most` letters.
std::string brief(const std::string& help, std::size_t most = 72);

/// Calls `each` with every command and the words that lead to it, "raya generate balls", the first one first.
template <class Each>
void for_each_command(const CommandText& command, const Each& each, const std::string& before = "") {
    const std::string path = before.empty() ? command.name : before + ' ' + command.name;
    each(command, path);
    for (const CommandText& one : command.commands) for_each_command(one, each, path);
}

/// The help of a command that the words `path` lead to, "raya generate balls": usage, summary, examples, commands, options
/// by their groups, what stands below. No line is longer than `width` letters but where a word is.
std::string help_text(const CommandText& command, const std::string& path, std::size_t width);

/// Section 1's page "raya" of the program, or "raya-render" of one of its commands, with the commands below it: what
/// help says of them, in man's macros. `commands` holds the program's commands, none for the program itself; `program`
/// is name and version.
struct ManPage {
    std::string name{};  // "raya-render"
    std::string text{};
};

/// The pages of the program and of each of its commands.
std::vector<ManPage> man_pages(const CommandText& program, const std::string& name_and_version);

}  // namespace raya
