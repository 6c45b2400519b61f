#include "host/cli/help.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/cli/options.hpp"

namespace raya {
namespace {

// Splits a text at `separator`: "none|bvh|grid[:AxBxC]" into none, bvh, grid. Returns an empty vector if there is only
// one part, or if a part is not two or more lower-case letters, digits or hyphens.
std::vector<std::string> choices_in(const std::string& text, char separator) {
    std::vector<std::string> choices;
    for (const std::string& part : split(text, separator)) {
        choices.push_back(part.substr(0, part.find('[')));
        if (choices.back().size() < 2 ||
            choices.back().find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos)
            return {};
    }
    return choices.size() > 1 ? choices : std::vector<std::string>{};
}

constexpr std::size_t kIndent = 2;              // number of blanks before names below a heading
constexpr std::size_t kDescriptionIndent = 6;   // number of blanks before descriptions below names
constexpr std::size_t kMaxNameColumn = 24;      // after a longer name, the description begins on the next line
constexpr std::size_t kMinTwoColumnWidth = 60;  // minimum line width for descriptions next to the names

// Wraps a text to lines of at most `width` characters. The first line already has `line_size` characters. Each further
// line begins with `indent` blanks. Each line except the last ends with `line_end`.
std::string wrapped(const std::string& text, std::size_t line_size, std::size_t indent, std::size_t width,
                    const std::string& line_end = "") {
    std::string lines, gap;
    std::istringstream words(text);
    for (std::string word; words >> word; gap = " ") {
        if (!gap.empty() && line_size + 1 + word.size() + line_end.size() > width) {
            lines += line_end + '\n' + std::string(indent, ' ') + word;
            line_size = indent + word.size();
        } else {
            lines += gap + word;
            line_size += gap.size() + word.size();
        }
    }
    return lines + '\n';
}

struct Entry {
    std::string name, description;
};
using Entries = std::vector<Entry>;

std::string names_of(const OptionText& option) {
    std::string text;
    for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + name;
    return option.is_flag() || option.is_argument() ? text : text + ' ' + option.placeholder;
}

std::string usage_of(const OptionText& o) {
    const std::string text =
        o.is_argument() ? o.names.front() + (o.repeated ? "..." : "") : o.names.front() + ' ' + o.placeholder;
    return o.required ? text : '[' + text + ']';
}

Entry entry_of(const OptionText& o) {
    if (o.help.empty()) return {names_of(o), o.placeholder};
    return {names_of(o), o.default_value.empty() ? o.help : o.help + "; default: " + o.default_value};
}

Entries entries_of(const std::vector<OptionText>& options, const std::string& group) {
    Entries entries;
    for (const OptionText& option : options)
        if (group.empty() || option.group == group) entries.push_back(entry_of(option));
    return entries;
}

// Returns the lines of a footer. A line "  NAME   description" becomes an entry; other lines have no description.
Entries footer_of(const std::string& footer) {
    Entries entries;
    std::istringstream lines(footer);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t gap = line.starts_with("  ") ? line.find("  ", kIndent) : std::string::npos;
        entries.push_back({line, ""});
        if (gap == std::string::npos) continue;
        entries.back() = {line.substr(kIndent, gap - kIndent), line.substr(line.find_first_not_of(' ', gap))};
    }
    return entries;
}

// Formats names and descriptions in two columns or, on a narrow terminal, each description below its name.
class Columns {
  public:
    Columns(const std::vector<Entries>& all, std::size_t width) : width_(width) {
        for (const Entries& entries : all)
            for (const Entry& entry : entries)
                if (entry.name.size() <= kMaxNameColumn) name_size_ = std::max(name_size_, entry.name.size());
    }

    std::string text_of(const Entries& entries) const {
        std::string text;
        for (const Entry& entry : entries) text += text_of(entry);
        return text;
    }

    std::string text_of(const Entry& entry) const {
        const bool two_columns = width_ >= kMinTwoColumnWidth;
        const std::size_t column = two_columns ? kIndent + name_size_ + 2 : kDescriptionIndent;
        std::string text = std::string(kIndent, ' ') + entry.name;
        if (entry.description.empty()) return text + '\n';
        if (two_columns && entry.name.size() <= name_size_)
            text += std::string(column - text.size(), ' ');
        else
            text += '\n' + std::string(column, ' ');
        return text + wrapped(entry.description, column, column, width_);
    }

  private:
    std::size_t width_, name_size_ = 0;
};

// Returns the line width in characters: that of the environment variable COLUMNS, else the terminal's, limited to
// 40..120, else 80.
std::size_t text_width() {
    constexpr std::size_t kDefaultWidth = 80, kMinWidth = 40, kMaxWidth = 120, kMaxColumns = 10'000;
    std::size_t width = parsed_number<std::size_t>(environment_value("COLUMNS")).value_or(0);
    if (width > kMaxColumns) width = 0;
    winsize size{};
    if (width == 0 && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
    return width == 0 ? kDefaultWidth : std::clamp(width, kMinWidth, kMaxWidth);
}

// Returns the choices that CLI::IsMember appends to the placeholder of a value: "{1,4,8,16}".
std::vector<std::string> is_member_choices(const std::string& type) {
    const std::size_t open = type.find('{'), close = type.rfind('}');
    if (open == std::string::npos || close == std::string::npos || close < open) return {};
    return split(type.substr(open + 1, close - open - 1), ',');
}

}  // namespace

std::vector<std::string> choices_of(const OptionText& option) {
    if (!option.choices.empty()) return option.choices;
    const std::vector<std::string> choices = choices_in(option.placeholder, '|');
    return choices.empty() ? choices_in(option.placeholder, ',') : choices;
}

std::vector<std::string> groups_of(const CommandText& command) {
    std::vector<std::string> groups;
    for (const OptionText& option : command.options)
        if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
    return groups;
}

std::string help_text(const CommandText& command, const std::string& path, std::size_t width) {
    Entries subcommands;
    for (const CommandText& subcommand : command.commands) subcommands.push_back({subcommand.name, subcommand.summary});
    const Entries arguments = entries_of(command.arguments, ""), footer = footer_of(command.footer);
    Entries named_lines = footer;
    std::erase_if(named_lines, [](const Entry& line) { return line.description.empty(); });
    const Columns columns({subcommands, arguments, entries_of(command.options, ""), named_lines}, width);

    std::string usage = path + (subcommands.empty() ? "" : " COMMAND");
    for (const OptionText& argument : command.arguments) usage += ' ' + usage_of(argument);
    for (const OptionText& option : command.options)
        if (option.required) usage += ' ' + usage_of(option);
    const std::string label = "Usage: ";
    std::string text = label + wrapped(usage + " [OPTIONS]", label.size(), label.size(), width) + '\n' +
                       wrapped(command.summary, 0, 0, width);
    std::string examples;
    for (const ExampleText& example : command.examples)  // " \\" continues a shell command on the next line
        examples += std::string(kIndent, ' ') + wrapped(example.command, kIndent, kDescriptionIndent, width, " \\") +
                    std::string(kDescriptionIndent, ' ') +
                    wrapped(example.description, kDescriptionIndent, kDescriptionIndent, width);
    const auto add = [&](const std::string& heading, const std::string& part) {
        if (!part.empty()) text += '\n' + heading + ":\n" + part;
    };
    add("Examples", examples);
    add("Commands", columns.text_of(subcommands));
    add("Arguments", columns.text_of(arguments));
    for (const std::string& group : groups_of(command)) add(group, columns.text_of(entries_of(command.options, group)));
    if (!footer.empty()) text += '\n';
    for (const Entry& line : footer)
        text += !line.description.empty() ? columns.text_of(line)
                : line.name.empty()       ? "\n"
                                          : wrapped(line.name, 0, kIndent, width);
    return text;
}

bool has_short_form(const CommandText& command) {
    return std::ranges::count_if(command.options, [](const OptionText& o) { return !o.brief.empty(); }) >=
           kMinBriefOptions;
}

CommandText short_form(CommandText command, const std::string& path) {
    if (!has_short_form(command)) return command;
    command.footer = path + " --help-all prints all " + std::to_string(command.options.size()) +
                     " options in full.\n\n" + command.footer;
    std::erase_if(command.options, [](const OptionText& o) { return o.brief.empty() && o.group != kGeneralOptions; });
    for (OptionText& option : command.options)
        if (!option.brief.empty()) option.help = option.brief;
    return command;
}

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
    CommandText text{.name = command.get_name(), .summary = command.get_description(), .footer = command.get_footer()};
    const auto* const formatter = dynamic_cast<const HelpFormatter*>(command.get_formatter().get());
    if (formatter != nullptr && formatter->examples.contains(&command))
        text.examples = formatter->examples.at(&command);
    // const_cast: CLI11 returns validators, which store the notes, only for a non-const option.
    for (CLI::Option* option : const_cast<CLI::App&>(command).get_options())
        if (!option->get_group().empty())
            (option->get_positional() ? text.arguments : text.options).push_back(option_text(*option));
    std::stable_partition(text.options.begin(), text.options.end(),
                          [](const OptionText& o) { return o.group != kGeneralOptions; });
    for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
        if (!subcommand->get_group().empty()) text.commands.push_back(command_text(*subcommand));
    return text;
}

}  // namespace raya
