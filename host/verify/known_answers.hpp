// The number layer's known answers: what each operation must give for operands that lead into its corners. Made by
// tests/verify/make_known_answers.cpp with MPFR, kept in known_answers.csv beside this file.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/machine/number_format.hpp"

namespace raya {

/// An operation of kernels/verify/operations.cl; results lie in the order of this list.
struct VerifiedOperation {
    const char* name;
    std::size_t operands;  // 1..3
};
inline constexpr std::array<VerifiedOperation, 12> kVerifiedOperations = {{{"add", 2},
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
                                                                           {"power", 2}}};

/// Bits of fp32 numbers; the operand of from_index is a whole number. Operands that the operation has not are 1.
/// Any NaN will do where the result is one.
struct KnownAnswer {
    std::array<std::uint32_t, 3> operands{};
    std::uint32_t result = 0;
};

/// All answers of one format.
struct FormatAnswers {
    NumberFormat format;
    std::array<std::vector<KnownAnswer>, kVerifiedOperations.size()> operations;  // in the order above
    std::size_t count() const;
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
