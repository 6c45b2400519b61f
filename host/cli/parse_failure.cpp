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

/// The first word that nothing takes, and whether it stands behind "--".
struct WordLeft {
    std::string word;
    bool after_mark = false;
};

WordLeft first_left(const CLI::App& program, const std::vector<std::string>& arguments) {
    const std::vector<std::string> left = program.remaining(true);
    const auto mark = std::find(arguments.begin(), arguments.end(), "--");
    const auto first = std::find_if(arguments.begin(), arguments.end(), [&](const std::string& word) {
        return word != "--" && std::find(left.begin(), left.end(), word) != left.end();
    });
    return first == arguments.end() ? WordLeft{} : WordLeft{*first, first > mark};
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

/// What an option is called here that other programs, or earlier versions, call otherwise.
std::string usual_name(const std::string& option) {
    if (option == "--ways") return "--variants";
    return option == "--width" || option == "--height" || option == "--resolution" ? "--size" : option;
}

std::string reason(const CLI::App& command, const WordLeft& first, const CLI::ParseError& error) {
    const std::vector<std::string> commands = command_names(command);
    const std::string& left = first.word;
    if (first.after_mark)
        return fmt::format("unexpected argument '{}' after --; options and commands belong before it", left);
    if (left.starts_with("-") && left.size() > 1) {
        const std::string word = left.substr(0, left.find('='));
        if (command.get_option_no_throw(word) != nullptr)
            return fmt::format("{} stands before {}, to which it belongs; let it follow", word, command.get_name());
        return fmt::format("no option {}{}", word, did_you_mean(usual_name(word), option_names(command)));
    }
    if (!left.empty() && commands.empty()) return fmt::format("unexpected argument '{}'", left);
    if (!left.empty() && command.get_option_no_throw("--" + left) != nullptr)
        return fmt::format("no command {} (did you mean --{}?)", left, left);
    if (!left.empty())
        return fmt::format("no command {}{}; there are {}", left, did_you_mean(left, commands),
                           fmt::join(commands, ", "));
    if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !commands.empty())
        return fmt::format("name a command: {}", fmt::join(commands, ", "));
    return of_values(error.what());
}

std::string failure_text(const CLI::App& program, const CLI::ParseError& error,
                         const std::vector<std::string>& arguments) {
    std::string name;
    const CLI::App& command = command_reached(program, name);
    const bool words_left = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                            dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    const WordLeft left = words_left ? first_left(program, arguments) : WordLeft{};
    return fmt::format("{}{}{}; see raya{} --help", name.empty() ? "" : name.substr(1), name.empty() ? "" : ": ",
                       reason(command, left, error), name);
}

/// The option whose value is the word behind this one, if any. Refuses what CLI11 reads otherwise than it is written:
/// it takes the value of a flag for a number, leaves "-=x" of "-q=x", and gives "--size=" the next word.
const CLI::Option* check_option(const CLI::App& command, const std::string& word) {
    const bool is_long = word.starts_with("--");
    const std::size_t equals = std::min(word.find('='), word.size());
    for (std::size_t at = 1, end = 0; end < word.size(); ++at) {
        end = is_long ? equals : at + 1;
        const std::string name = is_long ? word.substr(0, end) : std::string{'-', word[at]};
        const CLI::Option* option = command.get_option_no_throw(name);
        if (option == nullptr && at == 1) return nullptr;
        if (option == nullptr) throw UserError(fmt::format("{}: no option {}", word, name));
        const bool takes_value = option->get_items_expected_max() > 0;
        if (takes_value && is_long && equals + 1 == word.size())
            refuse_value(name, "", "must not be empty", option->get_description());
        if (takes_value) return end == word.size() ? option : nullptr;
        if (end == equals && end < word.size()) throw UserError(fmt::format("{}: {} takes no value", word, name));
    }
    return nullptr;
}

void check_words(const CLI::App& program, const std::vector<std::string>& arguments) {
    constexpr std::size_t kLongest = 4096;  // bytes: Linux's PATH_MAX
    const CLI::App* command = &program;
    const CLI::Option* asks = nullptr;  // for this word
    bool marked = false;
    for (const std::string& word : arguments) {
        if (word.size() > kLongest)
            throw UserError(
                fmt::format("{}: {} bytes are too many, at most {}",
                            asks ? asks->get_name() : word.substr(0, std::min<std::size_t>(word.find('='), 40)),
                            word.size(), kLongest));
        marked = marked || (asks == nullptr && word == "--");
        const bool free = asks == nullptr && !marked;
        asks = free && word.starts_with("-") ? check_option(*command, word) : nullptr;
        const auto next = command->get_subcommands([&](const CLI::App* one) { return one->get_name() == word; });
        if (free && !next.empty()) command = next.front();
    }
}

/// The text of a refusal "--fold blok: ..." with the word that the option offers and that is most like "blok".
std::string with_nearest(const CLI::App& program, std::string text) {
    std::string name;
    for (const CLI::Option* option : command_reached(program, name).get_options()) {
        const std::string start = option->get_name() + ' ';
        const std::size_t end = text.find(": ");
        if (!text.starts_with(start) || end == std::string::npos || end < start.size()) continue;
        const std::string value = text.substr(start.size(), end - start.size());
        // Validators, where words are kept, can be read of an option that is not const alone.
        const ValueText offered = value_of(option_text(*const_cast<CLI::Option*>(option)));
        if (!value.starts_with(nearest_name(value, offered.words)))  // "grid:4" is a grid
            text.insert(end, did_you_mean(value, offered.words));
        break;
    }
    return text;
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* one : command.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(one->get_name());
    return names;
}

void parse_words(CLI::App& program, const std::vector<std::string>& arguments) {
    try {
        check_words(program, arguments);
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) throw;  // help, version
        throw UserError(failure_text(program, error, arguments));
    } catch (const UserError& error) {
        const std::string text = with_nearest(program, error.what());
        if (text == error.what()) throw;
        throw UserError(text);
    }
}

}  // namespace raya
