#include "host/cli/quoted.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "host/base/encoding.hpp"

namespace raya {

std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
        return std::isalnum(c) || std::string_view("_-./:=+,%@").find(char(c)) != std::string_view::npos;
    });
    return plain ? word : '\'' + replaced(word, "'", "'\\''") + '\'';
}

}  // namespace raya
