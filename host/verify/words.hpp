// 32-bit words: as the files of known answers and pictures have them, and one that is never an answer.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace raya {

/// What results hold before a kernel runs, so that one that does nothing does not find the right ones there, left by
/// another: the answer of no check.
inline constexpr std::uint32_t kPoison = 0xdeadbeef;

/// 8 hexadecimal digits of which zeros at the end are left out: "3f8" is 0x3f800000. std::logic_error for anything
/// else.
inline std::uint32_t word_of(std::string digits) {
    if (digits.empty() || digits.size() > 8 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
        throw std::logic_error("'" + digits + "' is no word");
    digits.resize(8, '0');
    return static_cast<std::uint32_t>(std::stoul(digits, nullptr, 16));
}

/// The inverse.
inline std::string digits_of(std::uint32_t word) {
    std::string digits = fmt::format("{:08x}", word);
    while (digits.size() > 1 && digits.back() == '0') digits.pop_back();
    return digits;
}

}  // namespace raya
