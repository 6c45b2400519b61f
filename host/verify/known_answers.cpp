#include "host/verify/known_answers.hpp"

#include <fmt/core.h>

#include <bit>
#include <sstream>
#include <stdexcept>

#include "host/embedded.hpp"
#include "host/verify/words.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOne = 0x3f800000;  // 1.0f

constexpr const char* kHeading =
    "# Known answers of the number layer, made by tests/verify/make_known_answers.cpp with MPFR: do not edit.\n"
    "# Sections \"FORMAT OPERATION\"; then a line each: the operands' bits and the result's, as hexadecimal digits of "
    "fp32\n"
    "# numbers; zeros at the end are left out.\n";

std::size_t operation_number(const std::string& name) {
    for (std::size_t k = 0; k < kAnsweredOperations; ++k)
        if (name == kNumberOperations[k].name) return k;
    throw std::logic_error("known answers: no operation " + name);
}

KnownAnswer answer_of(const std::vector<std::string>& words, const NumberOperation& operation) {
    if (words.size() != operation.operands + 1)
        throw std::logic_error(fmt::format("known answers: {} words for {}", words.size(), operation.name));
    KnownAnswer answer{{kOne, kOne, kOne}, word_of(words.back())};
    for (std::size_t k = 0; k < operation.operands; ++k) answer.operands[k] = word_of(words[k]);
    return answer;
}

}  // namespace

std::vector<FormatAnswers> parse_known_answers(const std::string& text) {
    std::vector<FormatAnswers> all;
    std::size_t operation = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> words;
        std::istringstream in(line);
        for (std::string word; in >> word;) words.push_back(word);
        // A format's name has a letter that is no hexadecimal digit: "fp32", or the m of eXmY.
        if (words[0].find_first_of("mp") != std::string::npos && words.size() == 2) {
            const NumberFormat format = parse_format(words[0]);
            if (all.empty() || all.back().format != format) all.push_back({format, {}});
            operation = operation_number(words[1]);
            continue;
        }
        if (all.empty()) throw std::logic_error("known answers: a line before the first section");
        all.back().operations[operation].push_back(answer_of(words, kNumberOperations[operation]));
    }
    return all;
}

std::string known_answers_text(const std::vector<FormatAnswers>& all) {
    std::string text = kHeading;
    for (const FormatAnswers& answers : all)
        for (std::size_t k = 0; k < kAnsweredOperations; ++k) {
            text += fmt::format("{} {}\n", format_name(answers.format), kNumberOperations[k].name);
            for (const KnownAnswer& answer : answers.operations[k]) {
                for (std::size_t i = 0; i < kNumberOperations[k].operands; ++i)
                    text += digits_of(answer.operands[i]) + ' ';
                text += digits_of(answer.result) + '\n';
            }
        }
    return text;
}

const std::vector<FormatAnswers>& known_answers() {
    static const std::vector<FormatAnswers> all =
        parse_known_answers(embedded_files().at("host/verify/known_answers.csv"));
    return all;
}

}  // namespace raya
