#include "host/cli/command_text.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace raya {
namespace {

bool is_word(const std::string& text) {
    return text.size() > 1 && std::all_of(text.begin(), text.end(), [](unsigned char c) {
               return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
           });
}

// "none|bvh|grid[:AxBxC]" as none, bvh, grid; nothing where a part is no word.
std::vector<std::string> words_between(const std::string& text, char separator) {
    std::vector<std::string> words;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t to = std::min(text.find(separator, from), text.size());
        const std::string part = text.substr(from, to - from);
        words.push_back(part.substr(0, part.find('[')));
        if (!is_word(words.back())) return {};
        from = to + 1;
    }
    return words.size() > 1 ? words : std::vector<std::string>{};
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& starts) {
    return std::any_of(starts.begin(), starts.end(), [&](const std::string& one) { return text.starts_with(one); });
}

constexpr std::size_t kIndent = 2;        // of names below a heading
constexpr std::size_t kFarIndent = 6;     // of what is said of them, where it does not stand beside them
constexpr std::size_t kLongestName = 24;  // a longer one has a line of its own
constexpr std::size_t kTwoColumns = 60;   // letters that a line must have for names and what is said of them

struct Entry {
    std::string name, said;
};
using Entries = std::vector<Entry>;

/// Words of a text, of which `line` letters are on the current line already. Lines after it begin with `indent` blanks;
/// one that goes on ends in `end`.
std::string wrapped(const std::string& text, std::size_t line, std::size_t indent, std::size_t width,
                    const std::string& end = "") {
    std::string all;
    std::istringstream words(text);
    bool begins = true;
    for (std::string word; words >> word; begins = false) {
        const std::size_t gap = begins ? 0 : 1;
        if (!begins && line + gap + word.size() + end.size() > width) {
            all += end + '\n' + std::string(indent, ' ');
            line = indent;
        } else {
            all += std::string(gap, ' ');
            line += gap;
        }
        all += word;
        line += word.size();
    }
    return all + '\n';
}

class HelpPage {
  public:
    HelpPage(const CommandText& command, std::size_t width) : width_(width) {
        for (const Entry& entry : commands_of(command)) make_room(entry.name);
        for (const OptionText& word : command.words) make_room(names_of(word));
        for (const OptionText& option : command.options) make_room(names_of(option));
        for (const std::string& line : lines_of(command.footer))
            if (is_entry(line)) make_room(entry_of(line).name);
    }

    std::string usage(const CommandText& command, const std::string& path) const {
        const std::string begin = "Usage: ";
        std::string text = path;
        if (!command.commands.empty()) text += " COMMAND";
        for (const OptionText& word : command.words) text += ' ' + in_usage(word);
        for (const OptionText& option : command.options)
            if (option.required) text += ' ' + in_usage(option);
        return begin + wrapped(text + " [OPTIONS]", begin.size(), begin.size(), width_);
    }

    std::string paragraph(const std::string& text, std::size_t indent = 0) const {
        return wrapped(text, 0, indent, width_);
    }

    std::string examples(const std::vector<ExampleText>& all) const {
        std::string text;
        for (const ExampleText& one : all)  // broken as a shell reads it
            text += std::string(kIndent, ' ') + wrapped(one.command, kIndent, kFarIndent, width_, " \\") +
                    std::string(kFarIndent, ' ') + wrapped(one.says, kFarIndent, kFarIndent, width_);
        return text;
    }

    std::string entries(const Entries& all) const {
        std::string text;
        for (const Entry& entry : all) text += line_of(entry);
        return text;
    }

    static Entries commands_of(const CommandText& command) {
        Entries all;
        for (const CommandText& one : command.commands) all.push_back({one.name, one.summary});
        return all;
    }

    static Entries options_of(const std::vector<OptionText>& options, const std::string& group) {
        Entries all;
        for (const OptionText& option : options)
            if (option.group == group) all.push_back({names_of(option), said_of(option)});
        return all;
    }

    static Entries words_of(const std::vector<OptionText>& words) {
        Entries all;
        for (const OptionText& word : words) all.push_back({names_of(word), said_of(word)});
        return all;
    }

    /// Paragraphs below all options, some of them lists of names.
    std::string closing(const std::string& footer) const {
        std::string text;
        for (const std::string& line : lines_of(footer))
            text += line.empty() ? "\n" : is_entry(line) ? line_of(entry_of(line)) : paragraph(line, kIndent);
        return text;
    }

  private:
    // "  NAME   what it is"
    static bool is_entry(const std::string& line) {
        return line.starts_with("  ") && line.find("  ", kIndent) != std::string::npos;
    }

    static Entry entry_of(const std::string& line) {
        const std::size_t gap = line.find("  ", kIndent);
        return {line.substr(kIndent, gap - kIndent), line.substr(line.find_first_not_of(' ', gap))};
    }

    static std::vector<std::string> lines_of(const std::string& text) {
        std::vector<std::string> all;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) all.push_back(line);
        return all;
    }

    static std::string names_of(const OptionText& option) {
        std::string text;
        for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + name;
        return option.is_flag() || option.is_word() ? text : text + ' ' + option.value;
    }

    static std::string in_usage(const OptionText& o) {
        const std::string text =
            o.is_word() ? o.names.front() + (o.repeated ? "..." : "") : o.names.front() + ' ' + o.value;
        return o.required ? text : '[' + text + ']';
    }

    void make_room(const std::string& name) {
        if (name.size() <= kLongestName) longest_ = std::max(longest_, name.size());
    }

    std::string line_of(const Entry& entry) const {
        const bool beside = width_ >= kTwoColumns;
        const std::size_t column = beside ? kIndent + longest_ + 2 : kFarIndent;
        std::string text = std::string(kIndent, ' ') + entry.name;
        if (entry.said.empty()) return text + '\n';
        if (beside && entry.name.size() <= longest_)
            text += std::string(column - text.size(), ' ');
        else
            text += '\n' + std::string(column, ' ');
        return text + wrapped(entry.said, column, column, width_);
    }

    std::size_t width_;
    std::size_t longest_ = 0;
};

}  // namespace

ValueText value_of(const OptionText& option) {
    using enum ValueText::Kind;
    if (!option.words.empty()) return {.kind = option.repeated ? kList : kWords, .words = option.words};
    if (const auto words = words_between(option.value, '|'); !words.empty()) return {.kind = kWords, .words = words};
    if (const auto words = words_between(option.value, ','); !words.empty()) return {.kind = kList, .words = words};
    if (option.value.starts_with("DIR")) return {.kind = kFolder};
    if (!starts_with_any(option.value, {"FILE", "SCENE", "IMAGE"})) return {};
    const std::size_t dot = std::min(option.value.find('.'), option.value.size());
    std::string extension = option.value.substr(dot);
    return {.kind = kFile, .extension = extension.substr(0, extension.find('['))};
}

std::string said_of(const OptionText& option) {
    if (option.help.empty()) return option.value;
    return option.usual.empty() ? option.help : option.help + "; default: " + option.usual;
}

std::vector<std::string> groups_of(const CommandText& command) {
    std::vector<std::string> groups;
    for (const OptionText& option : command.options)
        if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
    return groups;
}

std::string brief(const std::string& help, std::size_t most) {
    std::string text = help.substr(0, std::min({help.find("; "), help.find(". "), help.find('\n')}));
    if (text.size() <= most) return text;
    const std::size_t space = text.rfind(' ', most - 4);
    return text.substr(0, space == std::string::npos ? most - 4 : space) + " ...";
}

std::string help_text(const CommandText& command, const std::string& path, std::size_t width) {
    const HelpPage page(command, width);
    std::string text = page.usage(command, path) + '\n' + page.paragraph(command.summary);
    const auto add = [&](const std::string& heading, const std::string& part) {
        if (!part.empty()) text += '\n' + heading + ":\n" + part;
    };
    add("Examples", page.examples(command.examples));
    add("Commands", page.entries(HelpPage::commands_of(command)));
    add("Arguments", page.entries(HelpPage::words_of(command.words)));
    for (const std::string& group : groups_of(command))
        add(group, page.entries(HelpPage::options_of(command.options, group)));
    return command.footer.empty() ? text : text + '\n' + page.closing(command.footer);
}

}  // namespace raya
