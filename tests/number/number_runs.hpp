// Runs the number layer on the default device, and defines the sizes of its tests.
#pragma once
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/verify/numbers.hpp"
#include "tests/kernels/unoptimised.hpp"
#include "tests/thorough.hpp"

namespace raya {

/// Returns the largest number of lanes to test: the environment variable RAYA_NUMBER_LANES, by default 16 if
/// thorough(), otherwise 4, as in kernels of other tests. The variable exists because some compilers take very long for
/// many lanes.
inline std::uint32_t widest_lanes() {
    const char* text = std::getenv("RAYA_NUMBER_LANES");
    return text == nullptr ? (thorough() ? 16 : 4) : static_cast<std::uint32_t>(std::stoul(text));
}

/// Returns the number of rows of random operands: the environment variable RAYA_NUMBER_CASES, by default
/// `default_rows`, rounded up to a multiple of kMaxLanes.
inline std::size_t row_count(std::size_t default_rows) {
    const char* text = std::getenv("RAYA_NUMBER_CASES");
    const std::size_t wanted = text == nullptr ? default_rows : std::stoul(text);
    return (wanted + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
}

/// Returns true if RAYA_NUMBER_CASES asks for more than twice the default number of rows.
inline bool is_long_run(std::size_t default_rows) { return row_count(default_rows) > 2 * default_rows; }

/// Returns a build that uses the device's division, square root and fma.
inline NumberBuild number_build(const NumberFormat& format, std::uint32_t lanes = widest_lanes()) {
    return {.format = format, .lanes = lanes};
}

/// Returns a build that refines divisions and square roots whose bits have errors of up to 3.
inline NumberBuild refined_build(const NumberFormat& format, std::uint32_t lanes = widest_lanes()) {
    return {.format = format, .lanes = lanes, .trusted = false, .imprecise = true};
}

/// Returns builds in fp32 with each number of lanes, with and without optimisation.
inline std::vector<NumberBuild> fp32_builds() {
    std::vector<NumberBuild> builds;
    for (const std::uint32_t lanes : {1u, 4u, 8u, 16u})
        for (const bool optimised : {true, false})
            if (lanes <= widest_lanes() && (optimised || tests_unoptimised(lanes)))
                builds.push_back({.format = {}, .lanes = lanes, .optimised = optimised});
    return builds;
}

/// Returns the results of run_numbers() on the default device.
inline NumberResults run_numbers(const NumberBuild& build, const NumberRows& rows) {
    Session session(choose_device(""));
    CheckRunner runner = number_runner(session, build);
    return run_numbers(runner, rows);
}

/// Returns a description of the wrong results, with details of the first wrong result; an empty text if all results are
/// as expected.
inline std::string wrong_numbers(const NumberBuild& build, const NumberRows& rows,
                                 const std::vector<ExpectedNumbers>& expected) {
    Session session(choose_device(""));
    const Verdict verdict = check_numbers(session, build, rows, expected);
    if (verdict.outcome == Outcome::kPass) return {};
    return verdict.result + "\n" + verdict.fault.where + "\nexpected " + verdict.fault.expected + "\ngot " +
           verdict.fault.got;
}

}  // namespace raya
