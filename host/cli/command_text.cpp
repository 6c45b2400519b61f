#include "host/cli/command_text.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace raya {
namespace {

// Returns true if the text has two or more characters, and all are lower-case letters, digits or hyphens.
bool is_keyword(const std::string& text) {
    return text.size() > 1 && std::all_of(text.begin(), text.end(), [](unsigned char c) {
               return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
           });
}

// Splits a text at `separator`: "none|bvh|grid[:AxBxC]" into none, bvh, grid. Returns an empty vector if a part is not
// a keyword or if there is only one part.
std::vector<std::string> choices_in(const std::string& text, char separator) {
    std::vector<std::string> choices;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        choices.push_back(part.substr(0, part.find('[')));
        if (!is_keyword(choices.back())) return {};
        begin = end + 1;
    }
    return choices.size() > 1 ? choices : std::vector<std::string>{};
}

constexpr std::size_t kIndent = 2;              // number of blanks before names below a heading
constexpr std::size_t kDescriptionIndent = 6;   // number of blanks before descriptions below names
constexpr std::size_t kMaxNameColumn = 24;      // after a longer name, the description begins on the next line
constexpr std::size_t kMinTwoColumnWidth = 60;  // minimum line width for descriptions next to the names

struct Entry {
    std::string name, description;
};
using Entries = std::vector<Entry>;

/// Wraps a text to lines of at most `width` characters. The first line already has `line_size` characters. Each further
/// line begins with `indent` blanks. Each line except the last ends with `line_end`.
std::string wrapped(const std::string& text, std::size_t line_size, std::size_t indent, std::size_t width,
                    const std::string& line_end = "") {
    std::string lines;
    std::istringstream words(text);
    bool is_first = true;
    for (std::string word; words >> word; is_first = false) {
        const std::size_t gap = is_first ? 0 : 1;
        if (!is_first && line_size + gap + word.size() + line_end.size() > width) {
            lines += line_end + '\n' + std::string(indent, ' ');
            line_size = indent;
        } else {
            lines += std::string(gap, ' ');
            line_size += gap;
        }
        lines += word;
        line_size += word.size();
    }
    return lines + '\n';
}

class HelpPage {
  public:
    HelpPage(const CommandText& command, std::size_t width) : width_(width) {
        for (const Entry& entry : subcommand_entries(command)) widen_for(entry.name);
        for (const OptionText& argument : command.arguments) widen_for(names_of(argument));
        for (const OptionText& option : command.options) widen_for(names_of(option));
        for (const std::string& line : lines_of(command.footer))
            if (is_entry(line)) widen_for(entry_of(line).name);
    }

    std::string usage(const CommandText& command, const std::string& path) const {
        const std::string label = "Usage: ";
        std::string text = path;
        if (!command.commands.empty()) text += " COMMAND";
        for (const OptionText& argument : command.arguments) text += ' ' + usage_text_of(argument);
        for (const OptionText& option : command.options)
            if (option.required) text += ' ' + usage_text_of(option);
        return label + wrapped(text + " [OPTIONS]", label.size(), label.size(), width_);
    }

    std::string paragraph(const std::string& text, std::size_t indent = 0) const {
        return wrapped(text, 0, indent, width_);
    }

    std::string examples(const std::vector<ExampleText>& list) const {
        std::string text;
        for (const ExampleText& example : list)  // " \\" continues a shell command on the next line
            text += std::string(kIndent, ' ') + wrapped(example.command, kIndent, kDescriptionIndent, width_, " \\") +
                    std::string(kDescriptionIndent, ' ') +
                    wrapped(example.description, kDescriptionIndent, kDescriptionIndent, width_);
        return text;
    }

    std::string entries(const Entries& list) const {
        std::string text;
        for (const Entry& entry : list) text += text_of(entry);
        return text;
    }

    static Entries subcommand_entries(const CommandText& command) {
        Entries list;
        for (const CommandText& subcommand : command.commands) list.push_back({subcommand.name, subcommand.summary});
        return list;
    }

    static Entries option_entries(const std::vector<OptionText>& options, const std::string& group) {
        Entries list;
        for (const OptionText& option : options)
            if (option.group == group) list.push_back({names_of(option), description_of(option)});
        return list;
    }

    static Entries argument_entries(const CommandText& command) {
        Entries list;
        for (const OptionText& argument : command.arguments)
            list.push_back({names_of(argument), description_of(argument)});
        return list;
    }

    /// Formats the footer: wraps its paragraphs, and aligns its lines "  NAME   description" in columns.
    std::string footer_text(const std::string& footer) const {
        std::string text;
        for (const std::string& line : lines_of(footer))
            text += line.empty() ? "\n" : is_entry(line) ? text_of(entry_of(line)) : paragraph(line, kIndent);
        return text;
    }

  private:
    // Returns true for a line "  NAME   description".
    static bool is_entry(const std::string& line) {
        return line.starts_with("  ") && line.find("  ", kIndent) != std::string::npos;
    }

    static Entry entry_of(const std::string& line) {
        const std::size_t gap = line.find("  ", kIndent);
        return {line.substr(kIndent, gap - kIndent), line.substr(line.find_first_not_of(' ', gap))};
    }

    static std::vector<std::string> lines_of(const std::string& text) {
        std::vector<std::string> lines;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        return lines;
    }

    static std::string names_of(const OptionText& option) {
        std::string text;
        for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + name;
        return option.is_flag() || option.is_argument() ? text : text + ' ' + option.placeholder;
    }

    static std::string usage_text_of(const OptionText& o) {
        const std::string text =
            o.is_argument() ? o.names.front() + (o.repeated ? "..." : "") : o.names.front() + ' ' + o.placeholder;
        return o.required ? text : '[' + text + ']';
    }

    void widen_for(const std::string& name) {
        if (name.size() <= kMaxNameColumn) max_name_size_ = std::max(max_name_size_, name.size());
    }

    std::string text_of(const Entry& entry) const {
        const bool two_columns = width_ >= kMinTwoColumnWidth;
        const std::size_t column = two_columns ? kIndent + max_name_size_ + 2 : kDescriptionIndent;
        std::string text = std::string(kIndent, ' ') + entry.name;
        if (entry.description.empty()) return text + '\n';
        if (two_columns && entry.name.size() <= max_name_size_)
            text += std::string(column - text.size(), ' ');
        else
            text += '\n' + std::string(column, ' ');
        return text + wrapped(entry.description, column, column, width_);
    }

    std::size_t width_;
    std::size_t max_name_size_ = 0;  // width of the column of names
};

}  // namespace

std::vector<std::string> choices_of(const OptionText& option) {
    if (!option.choices.empty()) return option.choices;
    const std::vector<std::string> choices = choices_in(option.placeholder, '|');
    return choices.empty() ? choices_in(option.placeholder, ',') : choices;
}

std::string description_of(const OptionText& option) {
    if (option.help.empty()) return option.placeholder;
    return option.default_value.empty() ? option.help : option.help + "; default: " + option.default_value;
}

std::vector<std::string> groups_of(const CommandText& command) {
    std::vector<std::string> groups;
    for (const OptionText& option : command.options)
        if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
    return groups;
}

std::string help_text(const CommandText& command, const std::string& path, std::size_t width) {
    const HelpPage page(command, width);
    std::string text = page.usage(command, path) + '\n' + page.paragraph(command.summary);
    const auto add = [&](const std::string& heading, const std::string& part) {
        if (!part.empty()) text += '\n' + heading + ":\n" + part;
    };
    add("Examples", page.examples(command.examples));
    add("Commands", page.entries(HelpPage::subcommand_entries(command)));
    add("Arguments", page.entries(HelpPage::argument_entries(command)));
    for (const std::string& group : groups_of(command))
        add(group, page.entries(HelpPage::option_entries(command.options, group)));
    return command.footer.empty() ? text : text + '\n' + page.footer_text(command.footer);
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

}  // namespace raya
