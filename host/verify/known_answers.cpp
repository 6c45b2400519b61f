// The known answers of the number layer as text.
#include <fmt/core.h>

#include <sstream>
#include <stdexcept>

#include "host/embedded.hpp"
#include "host/verify/numbers.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOne = 0x3f800000;  // 1.0f

constexpr const char* kHeading =
    "# Known answers of the number layer, made by tests/verify/make_known_answers.cpp with MPFR: do not edit.\n"
    "# A line \"FORMAT OPERATION\" starts a section. Each further line has the bits of the operands, of the "
    "result\n"
    "# and, if it differs, of the result of a device that replaces denormal operands and results by zeros:\n"
    "# fp32 numbers in hexadecimal without trailing zeros.\n";

std::size_t operation_number(const std::string& name) {
    for (std::size_t k = 0; k < kNumberOperations.size(); ++k)
        if (name == kNumberOperations[k].name) return k;
    throw std::logic_error("known answers: no operation " + name);
}

KnownAnswer answer_of(const std::vector<std::string>& fields, const NumberOperation& operation) {
    if (fields.size() != operation.operands + 1 && fields.size() != operation.operands + 2)
        throw std::logic_error(fmt::format("known answers: {} fields for {}", fields.size(), operation.name));
    KnownAnswer answer{{kOne, kOne, kOne}, word_of(fields[operation.operands]), word_of(fields.back())};
    for (std::size_t k = 0; k < operation.operands; ++k) answer.operands[k] = word_of(fields[k]);
    return answer;
}

}  // namespace

std::vector<FormatAnswers> parse_known_answers(const std::string& text) {
    std::vector<FormatAnswers> all;
    std::size_t operation = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> fields;
        std::istringstream in(line);
        for (std::string field; in >> field;) fields.push_back(field);
        // The name of a format contains a letter that is not a hexadecimal digit: the p of "fp32" or the m of "eXmY".
        if (fields[0].find_first_of("mp") != std::string::npos && fields.size() == 2) {
            const NumberFormat format = parse_format(fields[0]);
            if (all.empty() || all.back().format != format) all.push_back({format, {}});
            operation = operation_number(fields[1]);
            continue;
        }
        if (all.empty()) throw std::logic_error("known answers: a line before the first section");
        all.back().operations[operation].push_back(answer_of(fields, kNumberOperations[operation]));
    }
    return all;
}

std::string known_answers_text(const std::vector<FormatAnswers>& all) {
    std::string text = kHeading;
    for (const FormatAnswers& answers : all)
        for (std::size_t k = 0; k < kNumberOperations.size(); ++k) {
            text += fmt::format("{} {}\n", format_name(answers.format), kNumberOperations[k].name);
            for (const KnownAnswer& answer : answers.operations[k]) {
                for (std::size_t i = 0; i < kNumberOperations[k].operands; ++i)
                    text += digits_of(answer.operands[i]) + ' ';
                text += digits_of(answer.result);
                text += (answer.flushed != answer.result ? ' ' + digits_of(answer.flushed) : "") + '\n';
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
