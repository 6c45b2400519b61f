#include "host/cli/parse_failure.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "host/cli/command_tree.hpp"
#include "host/cli/nearest.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

/// Returns the innermost selected command. Appends its path without the program's name, " generate balls", to `path`.
const CLI::App& selected_command(const CLI::App& program, std::string& path) {
    const CLI::App* command = &program;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        path += ' ' + command->get_name();
    }
    return *command;
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// An argument that belongs to no option or command.
struct UnparsedArgument {
    std::string text;
    bool after_separator = false;  // true if the argument follows "--"
};

UnparsedArgument first_unparsed(const CLI::App& program, const std::vector<std::string>& arguments) {
    const std::vector<std::string> remaining = program.remaining(true);
    const auto separator = std::find(arguments.begin(), arguments.end(), "--");
    const auto first = std::find_if(arguments.begin(), arguments.end(), [&](const std::string& argument) {
        return argument != "--" && std::find(remaining.begin(), remaining.end(), argument) != remaining.end();
    });
    return first == arguments.end() ? UnparsedArgument{} : UnparsedArgument{*first, first > separator};
}

/// Rewords CLI11's message about too many or too few values.
std::string value_error_text(std::string text) {
    const auto replace = [&](const std::string& old_text, const std::string& new_text) {
        const std::size_t at = text.find(old_text);
        if (at != std::string::npos) text.replace(at, old_text.size(), new_text);
    };
    for (const char* const limit : {"At Most", "At most"})  // CLI11 2.2 and 2.6
        replace(std::string(limit) + " 1 required but received", "takes one value, not");
    replace("1 required ", "value ");
    return text;
}

/// Returns raya's present name of an option that earlier versions or other programs name differently.
std::string current_option_name(const std::string& option) {
    if (option == "--ways") return "--variants";
    return option == "--width" || option == "--height" || option == "--resolution" ? "--size" : option;
}

std::string failure_reason(const CLI::App& command, const UnparsedArgument& unparsed, const CLI::ParseError& error) {
    const std::vector<std::string> commands = command_names(command);
    const std::string& argument = unparsed.text;
    if (unparsed.after_separator)
        return fmt::format("unexpected argument '{}' after --; put options and commands before it", argument);
    if (argument.starts_with("-") && argument.size() > 1) {
        const std::string name = argument.substr(0, argument.find('='));
        if (command.get_option_no_throw(name) != nullptr)
            return fmt::format("{} is an option of {}; put it after {}", name, command.get_name(), command.get_name());
        return fmt::format("no option {}{}", name, did_you_mean(current_option_name(name), option_names(command)));
    }
    if (!argument.empty() && commands.empty()) return fmt::format("unexpected argument '{}'", argument);
    if (!argument.empty() && command.get_option_no_throw("--" + argument) != nullptr)
        return fmt::format("no command {} (did you mean --{}?)", argument, argument);
    if (!argument.empty())
        return fmt::format("no command {}{}; commands: {}", argument, did_you_mean(argument, commands),
                           fmt::join(commands, ", "));
    if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !commands.empty())
        return fmt::format("command missing; commands: {}", fmt::join(commands, ", "));
    return value_error_text(error.what());
}

std::string failure_text(const CLI::App& program, const CLI::ParseError& error,
                         const std::vector<std::string>& arguments) {
    std::string path;
    const CLI::App& command = selected_command(program, path);
    const bool has_unparsed = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                              dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    const UnparsedArgument unparsed = has_unparsed ? first_unparsed(program, arguments) : UnparsedArgument{};
    return fmt::format("{}{}{}; see raya{} --help", path.empty() ? "" : path.substr(1), path.empty() ? "" : ": ",
                       failure_reason(command, unparsed, error), path);
}

/// Returns the option in `argument` if the next argument is its value, otherwise null. Throws UserError for forms that
/// CLI11 misreads: "--quiet=x" (CLI11 reads x as a number), "-q=x" (as -q and "-=x") and "--size=" (CLI11 uses the next
/// argument as the value).
const CLI::Option* option_awaiting_value(const CLI::App& command, const std::string& argument) {
    const bool is_long = argument.starts_with("--");
    const std::size_t equals = std::min(argument.find('='), argument.size());
    for (std::size_t i = 1, end = 0; end < argument.size(); ++i) {
        end = is_long ? equals : i + 1;
        const std::string name = is_long ? argument.substr(0, end) : std::string{'-', argument[i]};
        const CLI::Option* option = command.get_option_no_throw(name);
        if (option == nullptr && i == 1) return nullptr;
        if (option == nullptr) throw UserError(fmt::format("{}: no option {}", argument, name));
        const bool takes_value = option->get_items_expected_max() > 0;
        if (takes_value && is_long && equals + 1 == argument.size())
            refuse_value(name, "", "must not be empty", option->get_description());
        if (takes_value) return end == argument.size() ? option : nullptr;
        if (end == equals && end < argument.size())
            throw UserError(fmt::format("{}: {} takes no value", argument, name));
    }
    return nullptr;
}

void check_argument_values(const CLI::App& program, const std::vector<std::string>& arguments) {
    constexpr std::size_t kMaxBytes = 4096;  // maximum size of an argument: Linux's PATH_MAX
    const CLI::App* command = &program;
    const CLI::Option* valued_option = nullptr;  // option whose value is the current argument; null: none
    bool after_separator = false;
    for (const std::string& argument : arguments) {
        if (argument.size() > kMaxBytes)
            throw UserError(fmt::format("{}: the value has {} bytes, maximum {}",
                                        valued_option
                                            ? valued_option->get_name()
                                            : argument.substr(0, std::min<std::size_t>(argument.find('='), 40)),
                                        argument.size(), kMaxBytes));
        after_separator = after_separator || (valued_option == nullptr && argument == "--");
        const bool may_be_option_or_command = valued_option == nullptr && !after_separator;
        valued_option =
            may_be_option_or_command && argument.starts_with("-") ? option_awaiting_value(*command, argument) : nullptr;
        const auto next =
            command->get_subcommands([&](const CLI::App* subcommand) { return subcommand->get_name() == argument; });
        if (may_be_option_or_command && !next.empty()) command = next.front();
    }
}

/// Adds to a message such as "--fold blok: ..." the option's choice that is most similar to the value.
std::string with_suggestion(const CLI::App& program, std::string text) {
    std::string path;
    for (const CLI::Option* option : selected_command(program, path).get_options()) {
        const std::string start = option->get_name() + ' ';
        const std::size_t end = text.find(": ");
        if (!text.starts_with(start) || end == std::string::npos || end < start.size()) continue;
        const std::string value = text.substr(start.size(), end - start.size());
        // const_cast: CLI11 returns validators, which store the choices, only for a non-const option.
        const ValueCompletion offered = value_completion(option_text(*const_cast<CLI::Option*>(option)));
        if (!value.starts_with(
                nearest_name(value, offered.choices)))  // "grid:4" starts with the choice grid, which is not misspelt
            text.insert(end, did_you_mean(value, offered.choices));
        break;
    }
    return text;
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(subcommand->get_name());
    return names;
}

void parse_arguments(CLI::App& program, const std::vector<std::string>& arguments) {
    try {
        check_argument_values(program, arguments);
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) throw;  // --help or --version, not an error
        throw UserError(failure_text(program, error, arguments));
    } catch (const UserError& error) {
        const std::string text = with_suggestion(program, error.what());
        if (text == error.what()) throw;
        throw UserError(text);
    }
}

}  // namespace raya
