#include "host/cli/parse_failure.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "host/cli/nearest.hpp"

namespace raya {
namespace {

/// The command that the words have led to, and its name behind the program's.
const CLI::App& command_reached(const CLI::App& program, std::string& name) {
    const CLI::App* command = &program;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        name += ' ' + command->get_name();
    }
    return *command;
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// The first word that nothing takes.
std::string first_left(const CLI::App& program, const std::vector<std::string>& arguments) {
    const std::vector<std::string> left = program.remaining(true);
    const auto first = std::find_if(arguments.begin(), arguments.end(), [&](const std::string& word) {
        return std::find(left.begin(), left.end(), word) != left.end();
    });
    return first == arguments.end() ? std::string() : *first;
}

/// What the parser says of an option with too many values or none, in other words.
std::string of_values(std::string text) {
    const auto replace = [&](const std::string& what, const std::string& by) {
        const std::size_t at = text.find(what);
        if (at != std::string::npos) text.replace(at, what.size(), by);
    };
    replace("At Most 1 required but received", "takes one value, not");
    replace("1 required ", "value ");
    return text;
}

std::string reason(const CLI::App& command, const std::string& left, const CLI::ParseError& error) {
    const std::vector<std::string> commands = command_names(command);
    if (left.starts_with("-") && left.size() > 1) {
        const std::string word = left.substr(0, left.find('='));
        if (command.get_option_no_throw(word) != nullptr)
            return fmt::format("{} stands before {}, to which it belongs; let it follow", word, command.get_name());
        return fmt::format("no option {}{}", word, did_you_mean(word, option_names(command)));
    }
    if (!left.empty() && commands.empty()) return fmt::format("{} is one word too many", left);
    if (!left.empty())
        return fmt::format("no command {}{}; there are {}", left, did_you_mean(left, commands),
                           fmt::join(commands, ", "));
    if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !commands.empty())
        return fmt::format("name a command: {}", fmt::join(commands, ", "));
    return of_values(error.what());
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* one : command.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(one->get_name());
    return names;
}

std::string parse_failure_text(const CLI::App& program, const CLI::ParseError& error,
                               const std::vector<std::string>& arguments) {
    std::string name;
    const CLI::App& command = command_reached(program, name);
    const bool words_left = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                            dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    const std::string left = words_left ? first_left(program, arguments) : "";
    return fmt::format("{}{}{}; see raya{} --help", name.empty() ? "" : name.substr(1), name.empty() ? "" : ": ",
                       reason(command, left, error), name);
}

}  // namespace raya
