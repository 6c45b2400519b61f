// Words as text, for the files of known answers and reference images.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <string>

namespace raya {

/// Inverse of word_of() (host/verify/verdict.hpp).
inline std::string digits_of(std::uint32_t word) {
    std::string digits = fmt::format("{:08x}", word);
    while (digits.size() > 1 && digits.back() == '0') digits.pop_back();
    return digits;
}

}  // namespace raya
