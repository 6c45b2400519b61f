// fish: a line for each command and option, which holds where the words have led to that command.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "host/cli/completion.hpp"

namespace raya {
namespace {

std::string fish_quoted(const std::string& text) {
    std::string all = "'";
    for (const char c : text) all += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return all + "'";
}

// fish takes what follows -a for words to be offered, or for a command in brackets.
std::string fish_offer_of(const OptionText& option) {
    const ValueText value = value_of(option);
    switch (value.kind) {
        case ValueText::Kind::kWords:
            return fmt::format(" -a '{}'", fmt::join(value.words, " "));
        case ValueText::Kind::kList:
            return fmt::format(" -a '(__fish_append , {})'", fmt::join(value.words, " "));
        case ValueText::Kind::kFile:
            return fmt::format(" -a '(__fish_complete_suffix \"{}\")'", value.extension);
        case ValueText::Kind::kFolder:
            return " -a '(__fish_complete_directories)'";
        case ValueText::Kind::kOther:
            break;
    }
    return "";
}

std::string line_of(const OptionText& option) {
    std::string text;
    for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.is_flag()) text += " -x" + fish_offer_of(option);
    return text + " -d " + fish_quoted(brief(option.help));
}

constexpr const char* kFishBeginning = R"(# raya's commands, options and values in fish. Made by: raya completion fish
# True where the words have led to the command $argv.
function __raya_at
    set -l node raya
    for word in (commandline -opc)[2..]
        contains -- "$node $word" $__raya_nodes; and set node "$node $word"
    end
    test "$node" = "$argv"
end
)";

}  // namespace

std::string fish_completion(const CommandText& program) {
    std::string nodes, lines;
    for_each_command(program, [&](const CommandText& command, const std::string& path) {
        const std::string here = fmt::format("complete -c raya -n '__raya_at {}'", path);
        nodes += ' ' + fish_quoted(path);
        for (const CommandText& one : command.commands)
            lines += fmt::format("{} -a {} -d {}\n", here, one.name, fish_quoted(brief(one.summary)));
        for (const OptionText& word : command.words)
            if (const std::string offer = fish_offer_of(word); !offer.empty()) lines += here + offer + '\n';
        for (const OptionText& option : command.options) lines += here + line_of(option) + '\n';
    });
    return kFishBeginning + ("set -g __raya_nodes" + nodes) + "\ncomplete -c raya -f\n" + lines;
}

}  // namespace raya
