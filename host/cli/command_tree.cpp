#include "host/cli/command_tree.hpp"

#include <algorithm>
#include <sstream>

#include "host/cli/help_formatter.hpp"
#include "host/cli/options.hpp"

namespace raya {
namespace {

// "{1,4,8,16}", which CLI::IsMember shows behind a value's name, as words.
std::vector<std::string> members_in(const std::string& type) {
    const std::size_t open = type.find('{'), close = type.rfind('}');
    std::vector<std::string> words;
    if (open == std::string::npos || close == std::string::npos || close < open) return words;
    std::istringstream list(type.substr(open + 1, close - open - 1));
    for (std::string word; std::getline(list, word, ',');) words.push_back(word);
    return words;
}

}  // namespace

OptionText option_text(CLI::Option& option) {
    OptionText text;
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
    if (option.get_positional()) text.names = {option.get_name(true)};
    const std::string type = option.get_type_size() == 0 ? "" : option.get_type_name();
    text.value = type.substr(0, type.find(":{"));
    text.usual = option.get_default_str();
    text.help = option.get_description();
    text.group = option.get_group();
    text.required = option.get_required();
    text.repeated = option.get_items_expected_max() > 1 || option.get_delimiter() != '\0';
    text.words = offered_words(option);
    if (text.words.empty()) text.words = members_in(type);
    return text;
}

namespace {

CommandText text_of(const CLI::App& command) {
    CommandText text;
    text.name = command.get_name();
    text.summary = command.get_description();
    text.examples = examples_of(command);
    text.footer = command.get_footer();
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty()) continue;
        // Validators, where words are kept, can be read of an option that is not const alone.
        auto& readable = *const_cast<CLI::Option*>(option);
        (option->get_positional() ? text.words : text.options).push_back(option_text(readable));
    }
    std::stable_partition(text.options.begin(), text.options.end(),
                          [](const OptionText& option) { return option.group != kCommonOptions; });
    for (const CLI::App* one : command.get_subcommands([](const CLI::App*) { return true; }))
        if (!one->get_group().empty()) text.commands.push_back(text_of(*one));
    return text;
}

}  // namespace

CommandText command_text(const CLI::App& program) {
    CommandText text = text_of(program);
    std::vector<std::string> names;
    for (const CommandText& one : text.commands) names.push_back(one.name);
    for (CommandText& one : text.commands)
        for (OptionText& word : one.words)
            if (word.value == "COMMAND") word.words = names;
    return text;
}

}  // namespace raya
