// The number layer's known answers: what each operation must give for operands that lead into its corners. Made by
// tests/verify/make_known_answers.cpp with MPFR, kept in known_answers.csv beside this file.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/verify/numbers.hpp"

namespace raya {

/// Bits of fp32 numbers; the operand of from_index is a whole number. Operands that the operation has not are 1.
/// Any NaN will do where the result is one.
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
