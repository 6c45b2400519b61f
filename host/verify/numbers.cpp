// The number layer against its known answers: every operation, format and rounding, bit by bit.
#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "host/verify/known_answers.hpp"
#include "host/verify/verify.hpp"
#include "host/verify/words.hpp"

namespace raya {
namespace {

constexpr std::size_t kMostLanes = 16;

bool is_denormal(std::uint32_t bits) { return std::fpclassify(std::bit_cast<float>(bits)) == FP_SUBNORMAL; }
bool is_nan(std::uint32_t bits) { return std::isnan(std::bit_cast<float>(bits)); }

// A device that promises no denormal numbers may make of them what it likes.
bool is_free(const KnownAnswer& answer, std::size_t operation, const DeviceInfo& device) {
    if (device.denormals) return false;
    bool some = is_denormal(answer.result);
    if (std::string(kVerifiedOperations[operation].name) != "from_index")
        for (const std::uint32_t operand : answer.operands) some = some || is_denormal(operand);
    return some;
}

bool agrees(std::uint32_t got, std::uint32_t expected) { return got == expected || (is_nan(got) && is_nan(expected)); }

std::string number_text(std::uint32_t bits) {
    return fmt::format("0x{:08x} = {:.9g}", bits, std::bit_cast<float>(bits));
}

std::string operands_text(const KnownAnswer& answer, std::size_t operation) {
    std::string text;
    for (std::size_t k = 0; k < kVerifiedOperations[operation].operands; ++k) {
        const std::uint32_t bits = answer.operands[k];
        const bool whole = std::string(kVerifiedOperations[operation].name) == "from_index";
        text += (k ? ", " : "") + (whole ? fmt::format("0x{:08x} = {}", bits, bits) : number_text(bits));
    }
    return text;
}

// The rows of all operations below each other, filled up to a multiple of the most lanes.
struct Rows {
    std::vector<float> operands[3];
    std::vector<std::size_t> first;  // row of each operation's first answer
    std::size_t count() const { return operands[0].size(); }
};

Rows rows_of(const FormatAnswers& answers) {
    Rows rows;
    for (const auto& of_operation : answers.operations) {
        rows.first.push_back(rows.count());
        for (const KnownAnswer& answer : of_operation)
            for (std::size_t k = 0; k < 3; ++k) rows.operands[k].push_back(std::bit_cast<float>(answer.operands[k]));
    }
    while (rows.count() % kMostLanes)
        for (auto& column : rows.operands) column.push_back(1);
    return rows;
}

std::vector<std::uint32_t> run_rows(Session& session, const Program& program, const Rows& rows, std::uint32_t lanes) {
    auto from = session.buffer<float>("operands", 3 * rows.count());
    auto to = session.buffer<std::uint32_t>("results", kVerifiedOperations.size() * rows.count());
    for (std::size_t k = 0; k < 3; ++k) session.write("operands", from, rows.operands[k], k * rows.count());
    session.fill("results", to, kPoison);
    auto kernel = program.kernel<const Buffer<float>&, cl_uint, Buffer<std::uint32_t>&>("operations");
    session.launch("operations", kernel, rows.count() / lanes, 1, from, static_cast<cl_uint>(rows.count()), to);
    std::vector<std::uint32_t> results(to.size());
    session.read("results", to, results);
    return results;
}

std::vector<std::string> remedies_for(const NumberFormat& format, const DeviceInfo& device,
                                      const std::vector<std::string>& of_lanes) {
    std::vector<std::string> all;
    if (format.is_fp32() && device.correctly_rounded_divide_sqrt)
        all.emplace_back(
            "if only div, sqrt or power is wrong: the device promises correctly rounded division and does not keep it");
    if (format.is_fp32())
        all.emplace_back(
            "if only mul_add is wrong: the compiler contracts a b + c in spite of FP_CONTRACT OFF; look for an option "
            "of the driver that forbids it");
    all.insert(all.end(), of_lanes.begin(), of_lanes.end());
    all.emplace_back("a newer driver, or another OpenCL implementation for this device (raya devices)");
    return all;
}

// All that is wrong in a line an operation, the first of it with bits. `known`: options and remedies of a fault.
Verdict compare(const FormatAnswers& answers, const Rows& rows, const std::vector<std::uint32_t>& results,
                const DeviceInfo& device, const Fault& known) {
    std::size_t wrong = 0, left_out = 0;
    std::string operations;
    Fault fault;
    for (std::size_t k = 0; k < answers.operations.size(); ++k) {
        std::size_t here = 0;
        for (std::size_t i = 0; i < answers.operations[k].size(); ++i) {
            const KnownAnswer& answer = answers.operations[k][i];
            const std::uint32_t got = results[k * rows.count() + rows.first[k] + i];
            left_out += is_free(answer, k, device);
            if (is_free(answer, k, device) || agrees(got, answer.result)) continue;
            if (wrong++ == 0)
                fault = {.where = fmt::format("{}({}) in {}", kVerifiedOperations[k].name, operands_text(answer, k),
                                              format_name(answers.format)),
                         .expected = number_text(answer.result),
                         .got = number_text(got)};
            ++here;
        }
        if (here)
            operations += fmt::format("{}{} of {} of {}", operations.empty() ? "" : ", ", here,
                                      answers.operations[k].size(), kVerifiedOperations[k].name);
    }
    if (wrong == 0) {
        const std::string denormals = left_out ? fmt::format(", {} denormal ones left out", left_out) : "";
        return passed(fmt::format("{} answers{}", answers.count() - left_out, denormals));
    }
    fault.options = known.options;
    fault.remedies = known.remedies;
    return failed("wrong: " + operations, fault);
}

// `trusted`: the device's own division, square root and fma are taken as it promises; else they are refined.
void verify_format(Verification& v, const FormatAnswers& answers, std::uint32_t lanes, bool trusted) {
    DeviceInfo device = v.device();
    if (!trusted) device.correctly_rounded_divide_sqrt = device.fused_multiply_add = false;
    const std::string name = fmt::format("{}, {} lane{}{}", format_name(answers.format), lanes, lanes == 1 ? "" : "s",
                                         trusted ? "" : ", division refined");
    v.check("number", name, [&](Session& session) {
        const Program program =
            v.build(session, "verify/operations.cl",
                    {.lanes = lanes, .format = answers.format, .exact_divide = trusted, .exact_fma = trusted});
        const Rows rows = rows_of(answers);
        return compare(
            answers, rows, run_rows(session, program, rows, lanes), device,
            {.options = program.options(), .remedies = remedies_for(answers.format, device, v.lanes_remedies(lanes))});
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
