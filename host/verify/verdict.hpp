// What came of a check, and what is wrong where it failed; and 32-bit words as the files of known answers have them.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace raya {

enum class Outcome { kPass, kFail, kSkip };

/// What is wrong, for somebody who has to find out why. What is not known is empty.
struct Fault {
    std::string where{};                  // the first operation, ray, word or pixel that is wrong
    std::string expected{}, got{};        // of it: bits, and what they mean
    std::string options{};                // build options of the kernel
    std::vector<std::string> remedies{};  // what to try, the likeliest first
};

/// How a check ended, in a line: what was compared, why it is skipped, or what is wrong.
struct Verdict {
    Outcome outcome = Outcome::kPass;
    std::string told;
    Fault fault{};  // of kFail
};

inline Verdict passed(std::string told) { return {Outcome::kPass, std::move(told)}; }
inline Verdict skipped(std::string reason) { return {Outcome::kSkip, std::move(reason)}; }
inline Verdict failed(std::string told, Fault fault) { return {Outcome::kFail, std::move(told), std::move(fault)}; }

/// A failure with what is known beside its place; any other verdict as it is.
inline Verdict with_remedies(Verdict verdict, const std::string& options, const std::vector<std::string>& remedies) {
    if (verdict.outcome != Outcome::kFail) return verdict;
    verdict.fault.options = options;
    verdict.fault.remedies = remedies;
    return verdict;
}

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
