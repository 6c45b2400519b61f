// Options of a command, which take what their values' types can hold.
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <type_traits>

namespace raya {

template <class Value>
inline constexpr bool kIsWhole = std::is_unsigned_v<Value>;
template <class Value>
inline constexpr bool kIsWhole<std::optional<Value>> = kIsWhole<Value>;

/// What is wrong with an option's value, or nothing: it must not be empty, and of whole numbers have digits alone. The
/// parser would take the first as not given and wrap negative numbers round.
std::string odd_value(const std::string& value, bool is_whole);

/// Adds an option that fills `value` and refuses odd values. Whole numbers are the unsigned types.
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value, const std::string& help = "") {
    CLI::Option* option = command.add_option(name, value, help);
    return option->check([](const std::string& text) { return odd_value(text, kIsWhole<Value>); });
}

}  // namespace raya
