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

namespace {

constexpr const char* kWords = "words";

}  // namespace

// A validator that is not active neither refuses values nor shows in help.
CLI::Option* offer_words(CLI::Option* option, const std::vector<std::string>& words) {
    const std::string text = fmt::format("{}", fmt::join(words, " "));
    try {
        option->get_validator(kWords)->description(text);
        return option;
    } catch (const CLI::OptionNotFound&) {
        return option->check(CLI::Validator(text).name(kWords).active(false));
    }
}

std::vector<std::string> offered_words(CLI::Option& option) {
    std::vector<std::string> words;
    try {
        CLI::Validator kept = *option.get_validator(kWords);
        std::istringstream text(kept.active().get_description());
        for (std::string word; text >> word;) words.push_back(word);
    } catch (const CLI::OptionNotFound&) {  // none were named
    }
    return words;
}

}  // namespace raya
