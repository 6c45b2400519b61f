// The number layer, operation by operation: rows of operands, the kernels that take them (kernels/checks/numbers.cl),
// and the comparison of results with expected ones, bit by bit. Where those come from is the caller's business: known
// answers, MPFR, the host.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "host/verify/check_runner.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

struct NumberOperation {
    const char* name;
    std::size_t operands;  // 1..3
};

/// In the order of the results in kernels/checks/numbers.cl.
inline constexpr std::array<NumberOperation, 16> kNumberOperations = {{{"add", 2},
                                                                       {"sub", 2},
                                                                       {"mul", 2},
                                                                       {"div", 2},
                                                                       {"sqrt", 1},
                                                                       {"mad", 3},
                                                                       {"mul_add", 3},
                                                                       {"max", 2},
                                                                       {"floor", 1},
                                                                       {"round", 1},
                                                                       {"from_index", 1},
                                                                       {"power", 2},
                                                                       {"neg", 1},
                                                                       {"abs", 1},
                                                                       {"log2", 1},
                                                                       {"exp2", 3}}};
/// Numbers of operations; exp2 is of the third operand.
enum NumberOperationNumber : std::size_t {
    kAdd,
    kSub,
    kMul,
    kDiv,
    kSqrt,
    kMad,
    kMulAdd,
    kMax,
    kFloor,
    kRound,
    kFromIndex,
    kPower,
    kNeg,
    kAbs,
    kLog2,
    kExp2
};
/// The first ones, which kernel `operations` does; `functions` does the others.
inline constexpr std::size_t kAnsweredOperations = kPower + 1;

/// Operands a, b, c, column by column. What an operation does not take is there all the same; of from_index, a is the
/// bits of a whole number.
struct NumberRows {
    std::vector<float> a, b, c;

    std::size_t count() const { return a.size(); }
    void add(float x, float y, float z);
    /// Adds rows of ones until their number is a multiple of kMostLanes.
    void pad();
};

/// [operation][row]: bits.
using NumberResults = std::vector<std::vector<std::uint32_t>>;

/// One way to build the layer.
struct NumberBuild {
    NumberFormat format;
    std::uint32_t lanes = 1;
    bool trusted = true;  // the device's own division, square root and fma are taken as it promises; else refined
    bool optimised = true;
    KernelSources sources{};

    /// "e6m15, 16 lanes, division refined"
    std::string name() const;
};

/// What an operation must give in rows that follow each other.
struct ExpectedNumbers {
    std::size_t operation;
    std::vector<std::uint32_t> results{};
    std::size_t first_row = 0;
};

class NumberRunner {
  public:
    NumberRunner(Session& session, const NumberBuild& build);

    const std::string& options() const { return runner_.options(); }

    /// All results, or only those of the first kAnsweredOperations. The number of rows is a multiple of kMostLanes.
    NumberResults run(const NumberRows& rows, bool all);

    /// "357 answers", or how many of each operation are wrong, and the first of them. Any NaN is as good as another; a
    /// device without denormal numbers may make of them what it likes.
    Verdict check(const NumberRows& rows, const std::vector<ExpectedNumbers>& expected);

  private:
    void append(NumberResults& results, const NumberRows& rows, const std::string& kernel, std::size_t count);

    NumberFormat format_;
    bool has_denormals_;
    CheckRunner runner_;
};

/// What an operation must give for operands that lead into its corners: made by tests/verify/make_known_answers.cpp
/// with MPFR, kept in known_answers.csv beside this file. Bits of fp32 numbers; the operand of from_index is a whole
/// number. Operands that the operation has not are 1. Any NaN will do where the result is one.
struct KnownAnswer {
    std::array<std::uint32_t, 3> operands{};
    std::uint32_t result = 0;
};

/// All answers of one format.
struct FormatAnswers {
    NumberFormat format;
    std::array<std::vector<KnownAnswer>, kAnsweredOperations> operations;  // in the order of kNumberOperations
};

/// Reads the file: a line "FORMAT OPERATION" opens a section, each further line has the operands' and the result's
/// bits, 8 hexadecimal digits of which zeros at the end are left out; # opens a comment. std::logic_error for what is
/// not so: the file is the project's own.
std::vector<FormatAnswers> parse_known_answers(const std::string& text);

/// The inverse.
std::string known_answers_text(const std::vector<FormatAnswers>& all);

/// Those that the program carries.
const std::vector<FormatAnswers>& known_answers();

}  // namespace raya
