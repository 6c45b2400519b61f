#include "host/cli/command_text.hpp"

#include <algorithm>
#include <cctype>

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

}  // namespace raya
