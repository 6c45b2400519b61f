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

constexpr std::size_t kDefaultWidth = 80, kMinWidth = 40, kMaxWidth = 120, kMaxColumns = 10'000;  // line widths

/// Returns the value of the environment variable COLUMNS; 0 if this value is not a number up to kMaxColumns.
std::size_t columns_variable() {
    const char* const columns = std::getenv("COLUMNS");
    if (columns == nullptr) return 0;
    const std::string_view text = columns;
    std::size_t width = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
    const bool is_legal = error == std::errc{} && end == text.data() + text.size() && width <= kMaxColumns;
    return is_legal ? width : 0;
}

std::size_t terminal_width() {
    winsize size{};
    return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

/// Returns the line width in characters, limited to 40..120: COLUMNS, else the terminal's width, else 80.
std::size_t text_width() {
    std::size_t width = columns_variable();
    if (width == 0) width = terminal_width();
    return width == 0 ? kDefaultWidth : std::clamp(width, kMinWidth, kMaxWidth);
}

// Returns the choices that CLI::IsMember appends to the placeholder of a value: "{1,4,8,16}".
std::vector<std::string> is_member_choices(const std::string& type) {
    const std::size_t open = type.find('{'), close = type.rfind('}');
    std::vector<std::string> choices;
    if (open == std::string::npos || close == std::string::npos || close < open) return choices;
    std::istringstream list(type.substr(open + 1, close - open - 1));
    for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
    return choices;
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const {
    const CommandText text = command_text(*command);
    return help_text(mode == CLI::AppFormatMode::All ? text : short_form(text, path), path, text_width());
}

void add_examples(CLI::App& command, std::vector<ExampleText> examples) {
    dynamic_cast<HelpFormatter&>(*command.get_formatter()).examples[&command] = std::move(examples);
}

OptionText option_text(CLI::Option& option) {
    OptionText text;
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
    if (option.get_positional()) text.names = {option.get_name(true)};
    const std::string type = option.get_type_size() == 0 ? "" : option.get_type_name();
    text.placeholder = type.substr(0, type.find(":{"));
    text.default_value = option.get_default_str();
    text.help = option.get_description();
    text.brief = note_of(option, kBriefNote);
    text.group = option.get_group();
    text.required = option.get_required();
    text.repeated = option.get_items_expected_max() > 1 || option.get_delimiter() != '\0';
    text.choices = offered_choices(option);
    if (text.choices.empty()) text.choices = is_member_choices(type);
    return text;
}

CommandText command_text(const CLI::App& command) {
    CommandText text;
    text.name = command.get_name();
    text.summary = command.get_description();
    const auto* const formatter = dynamic_cast<const HelpFormatter*>(command.get_formatter().get());
    if (formatter != nullptr && formatter->examples.contains(&command))
        text.examples = formatter->examples.at(&command);
    text.footer = command.get_footer();
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty()) continue;
        // const_cast: CLI11 returns validators, which store the choices, only for a non-const option.
        auto& mutable_option = *const_cast<CLI::Option*>(option);
        (option->get_positional() ? text.arguments : text.options).push_back(option_text(mutable_option));
    }
    std::stable_partition(text.options.begin(), text.options.end(),
                          [](const OptionText& option) { return option.group != kGeneralOptions; });
    for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
        if (!subcommand->get_group().empty()) text.commands.push_back(command_text(*subcommand));
    return text;
}

}  // namespace raya
