// Runs the operations of the number layer on rows of operands (kernels/checks/numbers.cl) and compares every bit of
// the results with the caller's expected results: known answers, results of MPFR or of the host's arithmetic.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

/// An operation of the number layer.
struct NumberOperation {
    const char* name;
    std::size_t operands;  // number of operands, 1..3
};

/// The operations in the order in which kernels/checks/numbers.cl returns their results.
inline constexpr NumberOperation kNumberOperations[] = {
    {"add", 2},   {"sub", 2},   {"mul", 2},        {"div", 2},   {"sqrt", 1}, {"mad", 3}, {"mul_add", 3}, {"max", 2},
    {"floor", 1}, {"round", 1}, {"from_index", 1}, {"power", 2}, {"neg", 1},  {"abs", 1}, {"log2", 1},    {"exp2", 3}};
/// Indices into kNumberOperations. exp2 reads only operand c.
inline constexpr std::size_t kAdd = 0, kSub = 1, kMul = 2, kDiv = 3, kSqrt = 4, kMad = 5, kMulAdd = 6, kMax = 7,
                             kFloor = 8, kRound = 9, kFromIndex = 10, kPower = 11, kNeg = 12, kAbs = 13, kLog2 = 14,
                             kExp2 = 15;

/// Operands a, b and c of each row. An operation ignores the operands that it does not need. For from_index, `a`
/// contains the bits of an integer.
struct NumberRows {
    std::vector<float> a, b, c;

    std::size_t count() const { return a.size(); }
    void add(float x, float y, float z);
    /// Appends rows of ones until the number of rows is a multiple of kMaxLanes.
    void pad();
};

/// Bits of results: [operation][row].
using NumberResults = std::vector<std::vector<std::uint32_t>>;

/// Options with which kernels/checks/numbers.cl is built.
struct NumberBuild {
    NumberFormat format;
    std::uint32_t lanes = 1;
    bool trusted = true;     // use the device's division, square root and fma if the device promises correct rounding;
                             // false: refine their results
    bool imprecise = false;  // simulate a device whose divisions and square roots have errors; needs `trusted` = false
    bool optimised = true;   // false: -cl-opt-disable
    KernelSources sources{};

    /// Returns text such as "e6m15, 16 lanes, fallback code".
    std::string name() const;
};

/// Expected results (bits) of an operation in consecutive rows, from `first_row` on. `flushed`: those of a device that
/// replaces denormal operands and results by zeros; empty: the same.
struct ExpectedNumbers {
    std::size_t operation;
    std::vector<std::uint32_t> results{}, flushed{};
    std::size_t first_row = 0;
};

/// Builds kernels/checks/numbers.cl.
CheckRunner number_runner(Session& session, const NumberBuild& build);

/// Returns the results of all operations. The number of rows must be a multiple of kMaxLanes.
NumberResults run_numbers(CheckRunner& runner, const NumberRows& rows);

/// Computes the operations and compares the results with `expected`. The verdict of a pass has a text such as "357
/// answers"; that of a failure states the number of wrong results of each operation and the first wrong result. Any NaN
/// matches any NaN. On devices that report no denormal numbers, the flushed results are right, too, with zeros of
/// either sign; the text states how often the device kept and flushed denormal numbers (OpenCL 3.0 C, 7.5.3).
Verdict check_numbers(Session& session, const NumberBuild& build, const NumberRows& rows,
                      const std::vector<ExpectedNumbers>& expected);

/// Operands and correct result of an edge case, as bits of fp32 numbers; the operand of from_index is an integer.
/// Unused operands are 1. tests/verify/make_known_answers.cpp computes the results with MPFR and prints
/// known_answers.csv.
struct KnownAnswer {
    std::array<std::uint32_t, 3> operands{};
    std::uint32_t result = 0, flushed = 0;  // flushed: if denormal operands and results are replaced by zeros
};

/// Known answers in one format.
struct FormatAnswers {
    NumberFormat format;
    std::array<std::vector<KnownAnswer>, std::size(kNumberOperations)> operations;  // in the order of kNumberOperations
};

/// Parses known_answers.csv. A line "FORMAT OPERATION" starts a section. Each further line has the bits of the
/// operands, of the result and, if it differs, of the flushed result, in hexadecimal without trailing zeros. # starts a
/// comment. Throws std::logic_error for most syntax errors; the file is generated, and a test compares it.
std::vector<FormatAnswers> parse_known_answers(const std::string& text);

/// Returns the answers of known_answers.csv, which is embedded in the program.
const std::vector<FormatAnswers>& known_answers();

}  // namespace raya
