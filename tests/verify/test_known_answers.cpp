// Tests of the known answers of the number layer: they equal the results of MPFR and cover every rounding feature.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "host/embedded.hpp"
#include "tests/verify/make_known_answers.hpp"

namespace raya {
namespace {

float value(std::uint32_t bits) { return std::bit_cast<float>(bits); }

}  // namespace

TEST_CASE("known_answers.csv: equals the output of make_known_answers", "[verify]") {
    CHECK(embedded_files().at("host/verify/known_answers.csv") == make_known_answers());
}

TEST_CASE("parse_known_answers: inverts known_answers_text", "[verify]") {
    const std::string text = embedded_files().at("host/verify/known_answers.csv");
    CHECK(known_answers_text(parse_known_answers(text)) == text);
    CHECK(text.size() < 72'000);  // small, because the program contains the text
}

TEST_CASE("known answers: every format has every operation, and covers ties and both ends of the range", "[verify]") {
    CHECK(known_answers().size() == 11);
    for (const FormatAnswers& answers : known_answers()) {
        CAPTURE(format_name(answers.format));
        for (const auto& operation_answers : answers.operations) CHECK(operation_answers.size() >= 3);
        std::set<std::string> seen;
        if (!answers.format.is_fp32()) {
            AnswerMaker maker(answers.format);
            for (const std::size_t k : {kAdd, kMul, kDiv, kMad})
                for (const KnownAnswer& a : answers.operations[k])
                    for (const std::string& feature :
                         maker.features(k, value(a.operands[0]), value(a.operands[1]), value(a.operands[2])))
                        seen.insert(feature);
            for (const char* feature : {"flushed +", "flushed -", "largest +", "largest -", "smallest", "zero -",
                                        "just above a tie +", "just below a tie -", kOtherMethod})
                CHECK(seen.count(feature) == 1);
            CHECK(seen.count(answers.format.truncates ? "tie down +" : "tie up +") == 1);
            if (answers.format.fraction_bits >= 10) CHECK(seen.count(kDoubleRounding) == 1);
        }
    }
}

}  // namespace raya
