// What came of a check, and what is wrong where it failed.
#pragma once
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

}  // namespace raya
