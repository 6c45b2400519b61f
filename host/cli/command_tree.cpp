#include "host/cli/command_tree.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include "host/cli/command_text.hpp"
#include "host/cli/options.hpp"

namespace raya {
namespace {

constexpr std::size_t kDefault = 80, kMinimum = 40, kMaximum = 120, kSane = 10'000;

/// 0: nothing that can be meant.
std::size_t named_width() {
    const char* const columns = std::getenv("COLUMNS");
    if (columns == nullptr) return 0;
    const std::string_view text = columns;
    std::size_t width = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
    const bool sane = error == std::errc{} && end == text.data() + text.size() && width <= kSane;
    return sane ? width : 0;
}

std::size_t terminal_width() {
    winsize size{};
    return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

/// Letters of a line for text on stdout, 40..120: what the environment variable COLUMNS says, where it is a number from
/// 1 to 10,000, else the terminal; 80 where stdout is none.
std::size_t text_width() {
    std::size_t width = named_width();
    if (width == 0) width = terminal_width();
    return width == 0 ? kDefault : std::clamp(width, kMinimum, kMaximum);
}

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

std::string HelpFormatter::make_help(const CLI::App* command, std::string path, CLI::AppFormatMode) const {
    return help_text(command_text(*command), path, text_width());
}

std::vector<ExampleText> HelpFormatter::examples_of(const CLI::App& command) const {
    const auto found = examples_.find(&command);
    return found == examples_.end() ? std::vector<ExampleText>{} : found->second;
}

void add_examples(CLI::App& command, std::vector<ExampleText> examples) {
    dynamic_cast<HelpFormatter&>(*command.get_formatter()).keep(command, std::move(examples));
}

std::vector<ExampleText> examples_of(const CLI::App& command) {
    const auto* const formatter = dynamic_cast<const HelpFormatter*>(command.get_formatter().get());
    return formatter == nullptr ? std::vector<ExampleText>{} : formatter->examples_of(command);
}

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
