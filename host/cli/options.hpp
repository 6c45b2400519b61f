// Options of a command. An option's value must be legal for the type of the variable that stores the value.
#pragma once
#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace raya {

/// The type of one value of an option: `Value` without std::optional or std::vector around it.
template <class Value>
struct OptionValue {
    using Type = Value;
};
template <class Value>
struct OptionValue<std::optional<Value>> : OptionValue<Value> {};
template <class Value>
struct OptionValue<std::vector<Value>> : OptionValue<Value> {};

/// Throws UserError with the option, the value, the reason, and the option's help text.
[[noreturn]] void refuse_value(const std::string& option, const std::string& value, const char* reason,
                               const std::string& help);

/// Throws UserError for an empty value, and for a number that is malformed or out of the type's range. Without this
/// check, CLI11 would treat an empty value as missing, wrap negative numbers and truncate large ones.
template <class Value>
void check_value(const std::string& option, const std::string& text, const std::string& help) {
    if (text.empty()) refuse_value(option, text, "must not be empty", help);
    if constexpr (std::is_arithmetic_v<Value>) {
        Value value{};
        const char* const end = text.data() + text.size();
        const auto [read_to, error] = std::from_chars(text.data(), end, value);
        const char* const reason = std::is_integral_v<Value> ? "not a whole number" : "not a number";
        const bool is_negative = std::is_unsigned_v<Value> && text.size() > 1 && text[0] == '-' &&
                                 text.find_first_not_of("0123456789", 1) == std::string::npos;
        if (is_negative || error == std::errc::result_out_of_range) refuse_value(option, text, "out of range", help);
        if (error != std::errc{} || read_to != end) refuse_value(option, text, reason, help);
    }
}

// Headings above groups of options in help.
inline constexpr const char* kFiles = "Files";
inline constexpr const char* kImageGroup = "Image";
inline constexpr const char* kCamera = "Camera and light";
inline constexpr const char* kMachine = "Machine and mapping";
inline constexpr const char* kTorusMachine = "Torus machine";
inline constexpr const char* kKernels = "Kernels and device";
inline constexpr const char* kDiagnostics = "Diagnostics";
inline constexpr const char* kGeneralOptions = "General options";  // options that every command has; listed last

/// Sets the heading of all options that are added to the command during this object's lifetime.
class OptionGroup {
  public:
    OptionGroup(CLI::App& command, const std::string& heading)
        : defaults_(*command.option_defaults()), previous_heading_(defaults_.get_group()) {
        defaults_.group(heading);
    }
    OptionGroup(const OptionGroup&) = delete;
    OptionGroup& operator=(const OptionGroup&) = delete;
    ~OptionGroup() { defaults_.group(previous_heading_); }

    /// Sets the heading of the options that are added from now on.
    void next(const std::string& heading) { defaults_.group(heading); }

  private:
    CLI::OptionDefaults& defaults_;
    std::string previous_heading_;
};

/// Adds an option, checks its value with check_value() and stores it in `value`.
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value, const std::string& help = "") {
    CLI::Option* option = command.add_option(name, value, help);
    return option->check([option](const std::string& text) {
        check_value<typename OptionValue<Value>::Type>(option->get_name(), text, option->get_description());
        return std::string();
    });
}

/// Attaches `text` to an option under the name `name`. Help does not show the text. note_of() returns the text, or ""
/// if no text has this name.
CLI::Option* attach_note(CLI::Option* option, const char* name, const std::string& text);
std::string note_of(CLI::Option& option, const char* name);

/// Sets the values that shell completion offers. They neither restrict the option's value nor appear in help. The
/// call is not needed if the placeholder in help lists the values: "ring|bus".
CLI::Option* offer_choices(CLI::Option* option, const std::vector<std::string>& choices);

/// Returns the values that offer_choices() set; empty if offer_choices() was not called.
std::vector<std::string> offered_choices(CLI::Option& option);

}  // namespace raya
