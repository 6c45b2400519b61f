#include "host/cli/parse_failure.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "host/base/encoding.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

/// Returns Damerau's edit distance from `a` to `b` without repeated edits of a character (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> distance(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                distance[i][j] = i + j;
                continue;
            }
            const std::size_t substitution = a[i - 1] == b[j - 1] ? 0 : 1;
            distance[i][j] =
                std::min({distance[i - 1][j] + 1, distance[i][j - 1] + 1, distance[i - 1][j - 1] + substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                distance[i][j] = std::min(distance[i][j], distance[i - 2][j - 2] + 1);
        }
    }
    return distance[a.size()][b.size()];
}

}  // namespace

std::string nearest_name(const std::string& misspelling, const std::vector<std::string>& names) {
    constexpr std::size_t kMinPrefixSize = 3;
    std::string nearest;
    std::size_t min_distance = misspelling.size() / 3 + 1;
    for (const std::string& name : names) {
        const bool has_prefix = misspelling.size() >= kMinPrefixSize && name.starts_with(misspelling);
        const std::size_t distance = has_prefix ? 0 : edit_distance(misspelling, name);
        if (distance >= min_distance) continue;
        min_distance = distance;
        nearest = name;
    }
    return nearest;
}

std::string did_you_mean(const std::string& misspelling, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(misspelling, names);
    return nearest.empty() ? "" : " (did you mean " + nearest + "?)";
}

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

std::string failure_reason(const CLI::App& program, const CLI::App& command, const CLI::ParseError& error,
                           const std::vector<std::string>& arguments) {
    const bool is_required = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    const std::vector<std::string> commands = command_names(command);
    std::vector<std::string> unparsed;
    if (is_required || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) unparsed = program.remaining(true);
    const auto first = std::ranges::find_if(arguments, [&](const std::string& argument) {
        return argument != "--" && std::ranges::find(unparsed, argument) != unparsed.end();
    });
    if (first != arguments.end() && first->starts_with("-") && first->size() > 1) {
        const std::string name = first->substr(0, first->find('='));
        return fmt::format("no option {}{}", name, did_you_mean(name, option_names(command)));
    }
    if (first != arguments.end() && commands.empty()) return fmt::format("unexpected argument '{}'", *first);
    if (first != arguments.end() && command.get_option_no_throw("--" + *first) != nullptr)
        return fmt::format("no command {} (did you mean --{}?)", *first, *first);
    if (first != arguments.end())
        return fmt::format("no command {}{}; commands: {}", *first, did_you_mean(*first, commands),
                           fmt::join(commands, ", "));
    if (is_required && !commands.empty())
        return fmt::format("command missing; commands: {}", fmt::join(commands, ", "));
    std::string text = error.what();
    for (const auto& [old_text, new_text] :
         {std::pair{"At Most 1 required but received", "takes one value, not"},  // CLI11 2.2
          {"At most 1 required but received", "takes one value, not"},           // CLI11 2.6
          {"1 required ", "value "}})
        text = replaced(text, old_text, new_text);
    return text;
}

/// Throws UserError for arguments that CLI11 would read in an unexpected way: it takes the value of "--quiet=x" as a
/// count, the next argument as the value of "--size=", and "-q=x" as -q and "-=x".
void check_arguments(const CLI::App& program, const std::vector<std::string>& arguments) {
    constexpr std::size_t kMaxBytes = 4096;  // maximum size of an argument: Linux's PATH_MAX
    const CLI::App* command = &program;
    std::string option;  // of the current argument, or before it
    for (const std::string& argument : arguments) {
        const std::size_t equals = argument.find('=');
        if (argument.starts_with("-")) option = argument.substr(0, std::min<std::size_t>(equals, 40));
        if (argument.size() > kMaxBytes)
            throw UserError(fmt::format("{}: the value has {} bytes, maximum {}", option, argument.size(), kMaxBytes));
        for (const CLI::App* subcommand : command->get_subcommands([](const CLI::App*) { return true; }))
            if (subcommand->get_name() == argument) command = subcommand;
        if (!argument.starts_with("-") || equals == std::string::npos) continue;
        const CLI::Option* const named = command->get_option_no_throw(option);
        if (named != nullptr && named->get_items_expected_max() == 0)
            throw UserError(option + ": the option takes no value");
        if (named != nullptr && !option.starts_with("--"))
            throw UserError(option + ": write a blank before the value, not =");
        if (named != nullptr && equals + 1 == argument.size()) throw UserError(option + " must not be empty");
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
        const std::vector<std::string> choices = choices_of(option_text(*const_cast<CLI::Option*>(option)));
        if (!value.starts_with(
                nearest_name(value, choices)))  // "grid:4" starts with the choice grid, which is not misspelt
            text.insert(end, did_you_mean(value, choices));
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
        check_arguments(program, arguments);
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) throw;  // --help or --version, not an error
        std::string path;
        const CLI::App& command = selected_command(program, path);
        throw UserError(fmt::format("{}{}{}; see raya{} --help", path.empty() ? "" : path.substr(1),
                                    path.empty() ? "" : ": ", failure_reason(program, command, error, arguments),
                                    path));
    } catch (const UserError& error) {
        const std::string text = with_suggestion(program, error.what());
        if (text == error.what()) throw;
        throw UserError(text);
    }
}

}  // namespace raya
