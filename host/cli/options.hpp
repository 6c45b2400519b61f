// Options of a command, which take what their values' types can hold.
#pragma once
#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace raya {

/// The type of an option's value behind std::optional or std::vector, of which each element is given by itself.
template <class Value>
struct OptionValue {
    using Type = Value;
};
template <class Value>
struct OptionValue<std::optional<Value>> : OptionValue<Value> {};
template <class Value>
struct OptionValue<std::vector<Value>> : OptionValue<Value> {};

/// Throws UserError, in which the help text says what would be right.
[[noreturn]] void refuse_value(const std::string& option, const std::string& value, const char* reason,
                               const std::string& help);

/// Refuses what is empty, and of numbers what does not read as one or does not fit the type. The parser would take the
/// first as not given, wrap negative numbers round and cut large ones.
template <class Value>
void check_value(const std::string& option, const std::string& text, const std::string& help) {
    if (text.empty()) refuse_value(option, text, "must not be empty", help);
    if constexpr (std::is_arithmetic_v<Value>) {
        Value value{};
        const char* const end = text.data() + text.size();
        const auto [read_to, error] = std::from_chars(text.data(), end, value);
        const char* const kind = std::is_integral_v<Value> ? "not a whole number" : "not a number";
        const bool below = std::is_unsigned_v<Value> && text.size() > 1 && text[0] == '-' &&
                           text.find_first_not_of("0123456789", 1) == std::string::npos;
        if (below || error == std::errc::result_out_of_range) refuse_value(option, text, "out of range", help);
        if (error != std::errc{} || read_to != end) refuse_value(option, text, kind, help);
    }
}

// Headings below which help shows options, in the commands that have them.
inline constexpr const char* kFiles = "Files";
inline constexpr const char* kPicture = "Picture";
inline constexpr const char* kCamera = "Camera and light";
inline constexpr const char* kMachine = "Machine and mapping";
inline constexpr const char* kTorusMachine = "Torus machine";
inline constexpr const char* kKernels = "Kernels and device";
inline constexpr const char* kCloserLook = "Looking closer";
inline constexpr const char* kCommonOptions = "Common options";  // of all commands; they stand last

/// The heading of all options that are added to a command while this lives.
class OptionGroup {
  public:
    OptionGroup(CLI::App& command, const std::string& heading)
        : defaults_(*command.option_defaults()), before_(defaults_.get_group()) {
        defaults_.group(heading);
    }
    OptionGroup(const OptionGroup&) = delete;
    OptionGroup& operator=(const OptionGroup&) = delete;
    ~OptionGroup() { defaults_.group(before_); }

    /// Of those that follow.
    void next(const std::string& heading) { defaults_.group(heading); }

  private:
    CLI::OptionDefaults& defaults_;
    std::string before_;
};

/// Adds an option that fills `value` and refuses odd values.
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value, const std::string& help = "") {
    CLI::Option* option = command.add_option(name, value, help);
    return option->check([option](const std::string& text) {
        check_value<typename OptionValue<Value>::Type>(option->get_name(), text, option->get_description());
        return std::string();
    });
}

/// Keeps a text with an option, which neither refuses values nor shows in help; empty of what was not kept.
CLI::Option* keep_note(CLI::Option* option, const char* name, const std::string& text);
std::string note_of(CLI::Option& option, const char* name);

/// Names words that the value may be, for shells to offer. Help does not show them, and they refuse
/// nothing. Where help calls the value by its words, as in "ring|bus", they need no naming.
CLI::Option* offer_words(CLI::Option* option, const std::vector<std::string>& words);

/// Those words, or none.
std::vector<std::string> offered_words(CLI::Option& option);

}  // namespace raya
