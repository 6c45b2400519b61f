// Runs of the number layer on the default device, and how long the tests of it are.
#pragma once
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/verify/numbers.hpp"

namespace raya {

/// 16, or what RAYA_NUMBER_LANES says: some compilers take very long for wide kernels.
inline std::uint32_t widest_lanes() {
    const char* text = std::getenv("RAYA_NUMBER_LANES");
    return text == nullptr ? 16 : static_cast<std::uint32_t>(std::stoul(text));
}

/// Rows of the random tests: RAYA_NUMBER_CASES, rounded up to a multiple of kMostLanes.
inline std::size_t number_cases(std::size_t usual) {
    const char* text = std::getenv("RAYA_NUMBER_CASES");
    const std::size_t wanted = text == nullptr ? usual : std::stoul(text);
    return (wanted + kMostLanes - 1) / kMostLanes * kMostLanes;
}

/// RAYA_NUMBER_CASES asks for more than the usual run.
inline bool is_long_run(std::size_t usual) { return number_cases(usual) > 2 * usual; }

/// By the device's own division, square root and fma.
inline NumberBuild number_build(const NumberFormat& format, std::uint32_t lanes = widest_lanes()) {
    return {.format = format, .lanes = lanes};
}

/// Results as NumberRunner::run() has them.
inline NumberResults run_numbers(const NumberBuild& build, const NumberRows& rows, bool all) {
    Session session(choose_device(""));
    return NumberRunner(session, build).run(rows, all);
}

/// What is wrong, with the first place; empty where all is as expected.
inline std::string wrong_numbers(const NumberBuild& build, const NumberRows& rows,
                                 const std::vector<ExpectedNumbers>& expected) {
    Session session(choose_device(""));
    const Verdict verdict = NumberRunner(session, build).check(rows, expected);
    if (verdict.outcome == Outcome::kPass) return {};
    return verdict.told + "\n" + verdict.fault.where + "\nexpected " + verdict.fault.expected + "\ngot " +
           verdict.fault.got;
}

}  // namespace raya
