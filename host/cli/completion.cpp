#include "host/cli/completion.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

namespace raya {

const std::vector<std::string>& completed_shells() {
    static const std::vector<std::string> shells = {"bash", "zsh", "fish"};
    return shells;
}

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

// Words that lead to a command, as `help study fig7` has them, are offered as commands are.
CommandText with_words_as_commands(const CommandText& program) {
    CommandText all = program;
    for (CommandText& command : all.commands) {
        if (command.words.size() != 1 || !command.words[0].repeated || command.words[0].value != "COMMAND") continue;
        command.words.clear();
        command.commands = names_below(program, command.options);
    }
    return all;
}

}  // namespace

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

}  // namespace raya
