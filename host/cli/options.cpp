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

// CLI11 options have no notes, so that the text is stored as the description of an inactive validator.
CLI::Option* attach_note(CLI::Option* option, const char* name, const std::string& text) {
    try {
        option->get_validator(name)->description(text);
        return option;
    } catch (const CLI::OptionNotFound&) {
        return option->check(CLI::Validator(text).name(name).active(false));
    }
}

std::string note_of(CLI::Option& option, const char* name) {
    try {
        CLI::Validator note = *option.get_validator(name);
        return note.active().get_description();
    } catch (const CLI::OptionNotFound&) {
        return "";
    }
}

constexpr const char* kChoices = "choices";

CLI::Option* offer_choices(CLI::Option* option, const std::vector<std::string>& choices) {
    return attach_note(option, kChoices, fmt::format("{}", fmt::join(choices, " ")));
}

std::vector<std::string> offered_choices(CLI::Option& option) {
    std::vector<std::string> choices;
    std::istringstream text(note_of(option, kChoices));
    for (std::string choice; text >> choice;) choices.push_back(choice);
    return choices;
}

}  // namespace raya
