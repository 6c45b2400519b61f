#include "host/cli/quoted.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "host/base/encoding.hpp"

namespace raya {

std::string quoted(const std::string& argument) {
    const bool plain = !argument.empty() && std::ranges::all_of(argument, [](unsigned char c) {
        return std::isalnum(c) || std::string_view("_-./:=+,%@").find(char(c)) != std::string_view::npos;
    });
    return plain ? argument : '\'' + replaced(argument, "'", "'\\''") + '\'';
}

}  // namespace raya
