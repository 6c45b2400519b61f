#include "host/cli/options.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <sstream>

#include "host/error.hpp"

namespace raya {

void refuse_value(const std::string& option, const std::string& value, const char* reason, const std::string& help) {
    throw UserError(value.empty() ? fmt::format("{} {}; {}: {}", option, reason, option, help)
                                  : fmt::format("{} {}: {}; {}: {}", option, value, reason, option, help));
}

// In a validator that is not active.
CLI::Option* keep_note(CLI::Option* option, const char* name, const std::string& text) {
    try {
        option->get_validator(name)->description(text);
        return option;
    } catch (const CLI::OptionNotFound&) {
        return option->check(CLI::Validator(text).name(name).active(false));
    }
}

std::string note_of(CLI::Option& option, const char* name) {
    try {
        CLI::Validator kept = *option.get_validator(name);
        return kept.active().get_description();
    } catch (const CLI::OptionNotFound&) {
        return "";
    }
}

constexpr const char* kWords = "words";

CLI::Option* offer_words(CLI::Option* option, const std::vector<std::string>& words) {
    return keep_note(option, kWords, fmt::format("{}", fmt::join(words, " ")));
}

std::vector<std::string> offered_words(CLI::Option& option) {
    std::vector<std::string> words;
    std::istringstream text(note_of(option, kWords));
    for (std::string word; text >> word;) words.push_back(word);
    return words;
}

}  // namespace raya
