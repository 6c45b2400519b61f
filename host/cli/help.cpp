#include "host/cli/help.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/cli/options.hpp"

namespace raya {
namespace {

constexpr std::size_t kWidth = 80;
constexpr std::size_t kIndent = 2;             // number of blanks before names below a heading
constexpr std::size_t kDescriptionIndent = 6;  // number of blanks before descriptions of examples
constexpr std::size_t kMaxNameColumn = 24;     // after a longer name, the description begins on the next line

// A name and its description, side by side.
using Entry = std::pair<std::string, std::string>;
using Entries = std::vector<Entry>;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 2 bad option or input, 3 device or driver failure, 4 a check failed, 1 an internal error.";

const Entries kEnvironment = {
    {"RAYA_DEVICE", "the device, unless --device is given"},
    {"RAYA_BUILD_OPTIONS", "added to every kernel's build options, and listed in reports"},
    {"RAYA_TUNED", "off: use the defaults, not the values that raya tune stored"},
    {"RAYA_PYTHON", "the Python that runs studies; default: /usr/bin/python3"},
    {"RAYA_MESH_TIMEOUT", "seconds that reading a mesh may take; default: 120"},
    {"RAYA_RANK_TIMEOUT", "seconds that a rank waits for other ranks; default: 600"},
    {"XDG_CACHE_HOME", "raya tune stores its values in raya/ in this folder; default: ~/.cache"}};

// Wraps a text. The first line already has `line_size` characters. Each further line begins with `indent` blanks. Each
// line except the last ends with `line_end`.
std::string wrapped(const std::string& text, std::size_t line_size, std::size_t indent,
                    const std::string& line_end = "") {
    std::string lines, gap;
    std::istringstream words(text);
    for (std::string word; words >> word; gap = " ") {
        if (!gap.empty() && line_size + 1 + word.size() + line_end.size() > kWidth) {
            lines += line_end + '\n' + std::string(indent, ' ') + word;
            line_size = indent + word.size();
        } else {
            lines += gap + word;
            line_size += gap.size() + word.size();
        }
    }
    return lines + '\n';
}

std::string placeholder_of(const CLI::Option& option) {
    const std::string type = option.get_type_size() == 0 ? "" : option.get_type_name();
    return type.substr(0, type.find(":{"));  // CLI::IsMember appends its choices
}

Entry entry_of(const CLI::Option& option, bool brief) {
    std::string names = replaced(option.get_name(true, true), ",", ", ");
    const std::string placeholder = placeholder_of(option), short_text = note_of(option, kBriefNote);
    if (!option.get_positional() && !placeholder.empty()) names += ' ' + placeholder;
    std::string text = brief && !short_text.empty() ? short_text : option.get_description();
    if (!option.get_default_str().empty()) text += "; default: " + option.get_default_str();
    return {names, text};
}

std::string usage_of(const CLI::Option& option) {
    const std::string name = option.get_snames().empty() ? option.get_name(true) : "-" + option.get_snames().front();
    const std::string text = option.get_positional() ? option.get_name(true) : name + ' ' + placeholder_of(option);
    return option.get_required() ? text : '[' + text + ']';
}

// Prints names and descriptions in two columns. Names have at least `name_size` characters.
std::string columns(const Entries& entries, std::size_t name_size) {
    const std::size_t column = kIndent + name_size + 2;
    std::string text;
    for (const auto& [name, description] : entries) {
        text += std::string(kIndent, ' ') + name;
        text +=
            name.size() <= name_size ? std::string(name_size - name.size() + 2, ' ') : '\n' + std::string(column, ' ');
        text += wrapped(description, column, column);
    }
    return text;
}

}  // namespace

std::vector<const CLI::Option*> listed_options(const CLI::App& command) {
    std::vector<const CLI::Option*> listed =
        command.get_options([](const CLI::Option* o) { return !o->get_group().empty(); });
    std::vector<std::string> groups;
    for (const CLI::Option* option : listed)
        if (std::ranges::find(groups, option->get_group()) == groups.end()) groups.push_back(option->get_group());
    std::ranges::stable_sort(listed, {}, [&](const CLI::Option* option) {
        const std::string& group = option->get_group();
        return group == kGeneralOptions ? groups.end() : std::ranges::find(groups, group);
    });
    return listed;
}

bool has_short_help(const CLI::App& command) {
    constexpr std::ptrdiff_t kMinBriefOptions = 5;
    return std::ranges::count_if(command.get_options([](const CLI::Option*) { return true; }), [](const auto* option) {
               return !note_of(*option, kBriefNote).empty();
           }) >= kMinBriefOptions;
}

std::string HelpFormatter::make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const {
    const bool brief = has_short_help(*command) && mode != CLI::AppFormatMode::All;
    const std::vector<const CLI::Option*> all_options = listed_options(*command);
    std::vector<std::pair<std::string, Entries>> sections;  // [heading, entries]
    const auto add = [&](const std::string& heading, Entry entry) {
        if (sections.empty() || sections.back().first != heading) sections.push_back({heading, {}});
        sections.back().second.push_back(std::move(entry));
    };
    for (const CLI::App* subcommand : command->get_subcommands({}))
        add("Commands", {subcommand->get_name(), subcommand->get_description()});
    std::string usage = path + (sections.empty() ? "" : " COMMAND");
    std::size_t option_count = 0;
    for (const CLI::Option* option : all_options)
        if (option->get_positional()) {
            usage += ' ' + usage_of(*option);
            add("Arguments", entry_of(*option, brief));
        }
    for (const CLI::Option* option : all_options) {
        if (option->get_positional()) continue;
        ++option_count;
        if (option->get_required()) usage += ' ' + usage_of(*option);
        const bool is_listed =
            !brief || !note_of(*option, kBriefNote).empty() || option->get_group() == kGeneralOptions;
        if (is_listed) add(option->get_group(), entry_of(*option, brief));
    }
    std::size_t name_size = 0;  // of all sections
    for (const auto& [heading, entries] : sections)
        for (const Entry& entry : entries)
            if (entry.first.size() <= kMaxNameColumn) name_size = std::max(name_size, entry.first.size());
    const bool is_program = command->get_parent() == nullptr;
    if (is_program) name_size = std::max(name_size, kEnvironment[1].first.size());  // the longest name

    const std::string label = "Usage: ";
    std::string text = label + wrapped(usage + " [OPTIONS]", label.size(), label.size()) + '\n' +
                       wrapped(command->get_description(), 0, 0) + "\nExamples:\n";
    for (const ExampleText& example : examples.at(command))  // " \\" continues a shell command on the next line
        text += std::string(kIndent, ' ') + wrapped(example.command, kIndent, kDescriptionIndent, " \\") +
                std::string(kDescriptionIndent, ' ') +
                wrapped(example.description, kDescriptionIndent, kDescriptionIndent);
    for (const auto& [heading, entries] : sections) text += '\n' + heading + ":\n" + columns(entries, name_size);
    if (brief) text += fmt::format("\n{} --help-all prints all {} options in full.\n", path, option_count);
    text += '\n' + wrapped(kExitCodes, 0, kIndent);
    if (is_program) text += "\nEnvironment:\n" + columns(kEnvironment, name_size);
    return text;
}

void add_examples(CLI::App& command, std::vector<ExampleText> examples) {
    dynamic_cast<HelpFormatter&>(*command.get_formatter()).examples[&command] = std::move(examples);
}

}  // namespace raya
