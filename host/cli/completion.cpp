#include "host/cli/completion.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

namespace raya {
namespace {

// A command's names of those below it, with no options but `options`.
std::vector<CommandText> names_below(const CommandText& command, const std::vector<OptionText>& options) {
    std::vector<CommandText> all;
    for (const CommandText& one : command.commands) {
        CommandText name;
        name.name = one.name;
        name.summary = one.summary;
        name.options = options;
        name.commands = names_below(one, options);
        all.push_back(std::move(name));
    }
    return all;
}

// Words that lead to a command, as `help generate balls` has them, are offered as commands are.
CommandText with_words_as_commands(const CommandText& program) {
    CommandText all = program;
    for (CommandText& command : all.commands) {
        if (command.words.size() != 1 || !command.words[0].repeated || command.words[0].value != "COMMAND") continue;
        command.words.clear();
        command.commands = names_below(program, command.options);
    }
    return all;
}

// What _raya_offer is told of a value.
std::string bash_offer_of(const OptionText& option) {
    const ValueText value = value_of(option);
    switch (value.kind) {
        case ValueText::Kind::kWords:
            return fmt::format("words {}", fmt::join(value.words, " "));
        case ValueText::Kind::kList:
            return fmt::format("list {}", fmt::join(value.words, " "));
        case ValueText::Kind::kFile:
            return "files " + value.extension;
        case ValueText::Kind::kFolder:
            return "folders";
        case ValueText::Kind::kOther:
            break;
    }
    return "nothing";
}

// What a command takes: names of commands and options, what a word alone may be, and of each option with a value that.
std::string bash_body_of(const CommandText& command) {
    std::vector<std::string> commands, options;
    std::string values;
    for (const CommandText& one : command.commands) commands.push_back(one.name);
    for (const OptionText& option : command.options) {
        options.insert(options.end(), option.names.begin(), option.names.end());
        if (!option.is_flag())
            values += fmt::format("        {}) value={} ;;\n", fmt::join(option.names, "|"),
                                  shell_quoted(bash_offer_of(option)));
    }
    std::string text =
        fmt::format("        commands='{}'\n        options='{}'\n        word={}\n", fmt::join(commands, " "),
                    fmt::join(options, " "),
                    shell_quoted(command.words.empty() ? "nothing" : bash_offer_of(command.words.front())));
    if (!values.empty()) text += "        case $1 in\n" + values + "        esac\n";
    return text;
}

constexpr const char* kBashBeginning = R"(# raya's commands, options and values in bash. Made by: raya completion bash
# Sets what the command $node takes: commands, options, word (what may stand alone), and value: what follows its option $1.
_raya_takes() {
    commands='' options='' word=nothing value=''
    case $node in
)";

constexpr const char* kBashEnd = R"(    esac
}

# COMPREPLY: what begins with $1 of that which $2... tells: words, words with commas between, files with an end, folders.
_raya_offer() {
    local begun=$1 kind=$2 before=''
    shift 2
    case $kind in
    list) [[ $begun != *,* ]] || { before=${begun%,*},; begun=${begun##*,}; } ;;&
    words | list) mapfile -t COMPREPLY < <(compgen -P "$before" -W "$*" -- "$begun") ;;
    files | folders)
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -d -- "$begun"; [[ $kind == folders ]] || compgen -f -X "!*$1" -- "$begun") ;;&
    files) mapfile -t COMPREPLY < <(printf '%s\n' "${COMPREPLY[@]}" | sort -u) ;;
    esac
    [[ ${#COMPREPLY[@]} != 1 || -n ${COMPREPLY[0]} ]] || COMPREPLY=()
}

_raya() {
    local node=raya asked='' commands options word value i one
    COMPREPLY=()
    for ((i = 1; i < COMP_CWORD; ++i)); do  # bash takes = and : for words
        one=${COMP_WORDS[i]}
        [[ $one != = ]] || continue
        [[ $one != : && ${COMP_WORDS[i - 1]} != : ]] || { asked=''; continue; }
        if [[ -n $asked ]]; then asked=''; continue; fi
        _raya_takes "$one"
        if [[ -n $value ]]; then asked=$value
        elif [[ " $commands " == *" $one "* ]]; then node+=" $one"; fi
    done
    one=${COMP_WORDS[COMP_CWORD]}
    [[ $one != : && ${COMP_WORDS[COMP_CWORD - 1]} != : ]] || return
    [[ $one != = ]] || one=''
    _raya_takes ''
    if [[ -n $asked ]]; then _raya_offer "$one" $asked
    elif [[ $one == -* ]]; then _raya_offer "$one" words $options
    elif [[ -n $commands ]]; then _raya_offer "$one" words $commands
    else _raya_offer "$one" $word; fi
}
complete -F _raya raya
)";

}  // namespace

const std::vector<std::string>& completed_shells() {
    static const std::vector<std::string> shells = {"bash", "zsh", "fish"};
    return shells;
}

std::string completion_script(const CommandText& as_parsed, const std::string& shell) {
    const CommandText program = with_words_as_commands(as_parsed);
    if (shell == "bash") return bash_completion(program);
    if (shell == "zsh") return zsh_completion(program);
    if (shell == "fish") return fish_completion(program);
    throw std::logic_error("no completion for " + shell);
}

std::string shell_quoted(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string shell_cases(const std::vector<std::pair<std::string, std::string>>& words_and_bodies) {
    std::vector<std::pair<std::string, std::string>> cases;  // patterns and their body
    for (const auto& [words, body] : words_and_bodies) {
        const auto same =
            std::find_if(cases.begin(), cases.end(), [&, &its = body](const auto& one) { return one.second == its; });
        if (same == cases.end())
            cases.emplace_back(shell_quoted(words), body);
        else
            same->first += '|' + shell_quoted(words);
    }
    std::string text;
    for (const auto& [patterns, body] : cases) text += fmt::format("    {})\n{}        ;;\n", patterns, body);
    return text;
}

std::string bash_completion(const CommandText& program) {
    std::vector<std::pair<std::string, std::string>> bodies;
    for_each_command(program, [&](const CommandText& command, const std::string& path) {
        bodies.emplace_back(path, bash_body_of(command));
    });
    return kBashBeginning + shell_cases(bodies) + kBashEnd;
}

}  // namespace raya
