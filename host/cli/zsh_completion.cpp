// zsh: a call of _arguments for each command, with what help says of each option.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "host/cli/completion.hpp"

namespace raya {
namespace {

// Text in which _arguments takes no letter for its own.
std::string zsh_plain(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') escaped += '\\';
        escaped += c;
    }
    return escaped;
}

// ":NAME:(a b)", what follows an option or stands alone.
std::string zsh_offer_of(const OptionText& option) {
    const ValueText value = value_of(option);
    const std::string name = ':' + zsh_plain(option.value) + ':';
    switch (value.kind) {
        case ValueText::Kind::kWords:
            return fmt::format("{}({})", name, fmt::join(value.words, " "));
        case ValueText::Kind::kList:
            return fmt::format("{}_values -s , {} {}", name, shell_quoted(zsh_plain(option.value)),
                               fmt::join(value.words, " "));
        case ValueText::Kind::kFile:
            return fmt::format("{}_files -g \"*{}(-.)\"", name, value.extension);
        case ValueText::Kind::kFolder:
            return name + "_files -/";
        case ValueText::Kind::kOther:
            break;
    }
    return name + "( )";
}

// Each name of an option by itself, which takes the others from what is offered next.
std::string arguments_of(const OptionText& option) {
    std::string text;
    for (const std::string& name : option.names) {
        const std::string others = option.repeated ? "*" : fmt::format("({})", fmt::join(option.names, " "));
        const std::string follows = option.is_flag() ? "" : name.starts_with("--") ? "=" : "+";
        const std::string spec = others + name + follows + '[' + zsh_plain(brief(option.help)) + ']';
        text += " \\\n            " + shell_quoted(option.is_flag() ? spec : spec + zsh_offer_of(option));
    }
    return text;
}

std::string zsh_body_of(const CommandText& command) {
    std::string text = "        _arguments -S";
    for (const OptionText& option : command.options) text += arguments_of(option);
    for (const OptionText& word : command.words)
        text += " \\\n            " + shell_quoted((word.repeated ? "*" : "") + zsh_offer_of(word));
    if (command.commands.empty()) return text + '\n';
    text = "        local -a commands=(";
    for (const CommandText& one : command.commands)
        text += "\n            " + shell_quoted(zsh_plain(one.name) + ':' + brief(one.summary));
    text += ")\n        if [[ $PREFIX == -* ]]; then\n    _arguments -S";
    for (const OptionText& option : command.options) text += arguments_of(option);
    return text + "\n        else\n            _describe command commands\n        fi\n";
}

constexpr const char* kZshBeginning = R"zsh(#compdef raya
# raya's commands, options and values in zsh. Made by: raya completion zsh

_raya() {
    local node=raya
    integer at=1
    # The words of a command lead, as in: raya generate balls.
    while ((at + 1 < CURRENT)) && [[ " $_raya_nodes " == *" ${node// /_}_$words[at+1] "* ]]; do
        node+=" $words[++at]"
    done
    words=("${(@)words[at,-1]}")
    ((CURRENT -= at - 1))
    case $node in
)zsh";

constexpr const char* kZshEnd = R"zsh(    esac
}

)zsh";

}  // namespace

std::string zsh_completion(const CommandText& program) {
    std::vector<std::pair<std::string, std::string>> bodies;
    std::string nodes;
    for_each_command(program, [&](const CommandText& command, const std::string& path) {
        bodies.emplace_back(path, zsh_body_of(command));
        std::string node = path;
        for (char& c : node) c = c == ' ' ? '_' : c;
        nodes += (nodes.empty() ? "" : " ") + node;
    });
    return kZshBeginning + shell_cases(bodies) + kZshEnd + "typeset -g _raya_nodes=" + shell_quoted(nodes) +
           "\nif [[ $funcstack[1] == _raya ]]; then _raya \"$@\"; else compdef _raya raya; fi\n";
}

}  // namespace raya
