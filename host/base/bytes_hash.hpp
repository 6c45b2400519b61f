// By what files and texts are known again.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace raya {

/// Two lower-case hexadecimal digits a byte.
std::string hex_digits(std::span<const unsigned char> bytes);

/// XXH3 of 128 bits, as 32 lower-case hexadecimal digits.
std::string bytes_hash(std::string_view bytes);

}  // namespace raya
