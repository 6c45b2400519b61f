// The known answers are what MPFR gives, and lead into every corner of rounding.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/cli/run_program.hpp"
#include "tests/paths.h"
#include "tests/verify/make_known_answers.hpp"

namespace raya {
namespace {

float value(std::uint32_t bits) { return std::bit_cast<float>(bits); }

// What the host's fp32 makes of a row; of power, what the file says.
float host_result(const std::string& name, const KnownAnswer& answer) {
    const float a = value(answer.operands[0]), b = value(answer.operands[1]), c = value(answer.operands[2]);
    if (name == "add") return a + b;
    if (name == "sub") return a - b;
    if (name == "mul") return a * b;
    if (name == "div") return a / b;
    if (name == "sqrt") return std::sqrt(a);
    if (name == "mad") return std::fma(a, b, c);
    if (name == "mul_add") return static_cast<float>(a * b) + c;
    if (name == "max") return a > b ? a : b;
    if (name == "floor") return std::floor(a);
    if (name == "round") return a;
    if (name == "from_index") return static_cast<float>(answer.operands[0]);
    return value(answer.result);
}

}  // namespace

TEST_CASE("the file of known answers is what its program makes", "[verify]") {
    CHECK(file_contents(RAYA_SOURCE_DIR "/host/verify/known_answers.csv") == make_known_answers());
}

TEST_CASE("known answers come back from their text", "[verify]") {
    const std::string text = file_contents(RAYA_SOURCE_DIR "/host/verify/known_answers.csv");
    CHECK(known_answers_text(parse_known_answers(text)) == text);
    CHECK(text.size() < 65'536);  // small enough to be carried in the program
}

TEST_CASE("known answers in fp32 are the host's", "[verify]") {
    const FormatAnswers& fp32 = known_answers().front();
    REQUIRE(fp32.format.is_fp32());
    for (std::size_t k = 0; k < kVerifiedOperations.size(); ++k)
        for (const KnownAnswer& answer : fp32.operations[k]) {
            CAPTURE(kVerifiedOperations[k].name, answer.operands, answer.result);
            const float expected = host_result(kVerifiedOperations[k].name, answer), found = value(answer.result);
            if (std::isnan(expected))
                CHECK(std::isnan(found));
            else
                CHECK(std::bit_cast<std::uint32_t>(expected) == answer.result);
        }
}

TEST_CASE("every format has answers of every operation, ties and both ends of the range among them", "[verify]") {
    CHECK(known_answers().size() == 11);
    for (const FormatAnswers& answers : known_answers()) {
        CAPTURE(format_name(answers.format));
        for (const auto& of_operation : answers.operations) CHECK(of_operation.size() >= 3);
        MpfrOracle oracle(answers.format);
        std::set<std::string> seen;
        if (!answers.format.is_fp32()) {
            AnswerMaker<MpfrOracle> maker(oracle, answers.format);
            for (std::size_t k : {0u, 2u, 3u, 5u})
                for (const KnownAnswer& a : answers.operations[k])
                    for (const std::string& feature : maker.features(kVerifiedOperations[k].name, value(a.operands[0]),
                                                                     value(a.operands[1]), value(a.operands[2])))
                        seen.insert(feature);
            for (const char* feature : {"flushed +", "flushed -", "largest +", "largest -", "smallest", "zero -",
                                        "just above a tie +", "just below a tie -", kOtherWay})
                CHECK(seen.count(feature) == 1);
            CHECK(seen.count(answers.format.truncates ? "tie down +" : "tie up +") == 1);
            if (answers.format.fraction_bits >= 10) CHECK(seen.count(kTwice) == 1);
        }
    }
}

TEST_CASE("a file of known answers that is not so is refused", "[verify]") {
    for (const char* text :
         {"3f8 3f8\n", "fp32 add\n3f8 3f8\n", "fp32 add\n3f8 3f8 3f8x\n", "fp32 pow\n", "fp32 sqrt\n123456789 0\n"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_known_answers(text), std::logic_error);
    }
}

}  // namespace raya
