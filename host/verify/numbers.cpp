// The number layer against its known answers: every operation, format and rounding, bit by bit.
#include "host/checks/numbers.hpp"

#include <bit>

#include "host/verify/known_answers.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

std::vector<std::string> remedies_for(const NumberBuild& build, const DeviceInfo& device,
                                      const std::vector<std::string>& of_lanes) {
    std::vector<std::string> all;
    if (build.format.is_fp32() && build.trusted && device.correctly_rounded_divide_sqrt)
        all.emplace_back(
            "if only div, sqrt or power is wrong: the device promises correctly rounded division and does not keep it");
    if (build.format.is_fp32())
        all.emplace_back(
            "if only mul_add is wrong: the compiler contracts a b + c in spite of FP_CONTRACT OFF; look for an option "
            "of the driver that forbids it");
    all.insert(all.end(), of_lanes.begin(), of_lanes.end());
    all.emplace_back("a newer driver, or another OpenCL implementation for this device (raya devices)");
    return all;
}

// The rows of all operations below each other, each operation's answers for its own alone.
Verdict check_answers(Session& session, const NumberBuild& build, const FormatAnswers& answers,
                      const std::vector<std::string>& remedies) {
    NumberRows rows;
    std::vector<ExpectedNumbers> expected;
    for (std::size_t k = 0; k < answers.operations.size(); ++k) {
        expected.push_back({.operation = k, .first_row = rows.count()});
        for (const KnownAnswer& answer : answers.operations[k]) {
            const auto operand = [&](std::size_t i) { return std::bit_cast<float>(answer.operands[i]); };
            rows.add(operand(0), operand(1), operand(2));
            expected.back().results.push_back(answer.result);
        }
    }
    rows.pad();
    NumberRunner runner(session, build);
    return with_remedies(runner.check(rows, expected), runner.options(), remedies);
}

void verify_format(Verification& v, const FormatAnswers& answers, std::uint32_t lanes, bool trusted) {
    const NumberBuild build{.format = answers.format, .lanes = lanes, .trusted = trusted, .sources = v.sources()};
    v.check("number", build.name(), [&](Session& session) {
        return check_answers(session, build, answers, remedies_for(build, v.device(), v.lanes_remedies(lanes)));
    });
}

// One format for each way of the layer: fp32, fewer exponent bits or fp32's own, either rounding.
bool is_usual(const NumberFormat& format) {
    for (const char* name : {"fp32", "e6m15", "e6m15t", "e5m10", "e8m12", "e8m21t"})
        if (format == parse_format(name)) return true;
    return false;
}

}  // namespace

void verify_numbers(Verification& v) {
    for (const FormatAnswers& answers : known_answers()) {
        if (!v.full() && !is_usual(answers.format)) continue;
        for (const std::uint32_t lanes : v.lanes()) verify_format(v, answers, lanes, true);
        const bool promises = v.device().correctly_rounded_divide_sqrt || v.device().fused_multiply_add;
        if (v.full() && promises) verify_format(v, answers, v.own_lanes(), false);
    }
}

}  // namespace raya
