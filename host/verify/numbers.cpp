#include "host/verify/numbers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <sstream>

#include "host/cl/kernel_options.hpp"
#include "host/cl/measure.hpp"
#include "host/embedded.hpp"
#include "host/verify/verify.hpp"
#include "kernels/shared/chains.h"

namespace raya {
namespace {

bool is_nan(std::uint32_t bits) { return std::isnan(std::bit_cast<float>(bits)); }
bool is_zero(std::uint32_t bits) { return bits << 1 == 0; }
bool agrees(std::uint32_t got, std::uint32_t expected) { return got == expected || (is_nan(got) && is_nan(expected)); }

std::string number_text(std::uint32_t bits) {
    return fmt::format("0x{:08x} = {:.9g}", bits, std::bit_cast<float>(bits));
}

std::string operands_text(std::size_t operation, const std::array<std::uint32_t, 3>& operands) {
    std::string text;
    for (std::size_t k = 0; k < kNumberOperations[operation].operands; ++k)
        text += (k ? ", " : "") + (operation == kFromIndex ? fmt::format("0x{:08x} = {}", operands[k], operands[k])
                                                           : number_text(operands[k]));
    return text;
}

Fault fault_of(const NumberFormat& format, std::size_t operation, const NumberRows& rows, std::size_t row,
               std::uint32_t expected, std::uint32_t got) {
    const std::array operands = {std::bit_cast<std::uint32_t>(rows.a[row]), std::bit_cast<std::uint32_t>(rows.b[row]),
                                 std::bit_cast<std::uint32_t>(rows.c[row])};
    return {.where = fmt::format("{}({}) in {}", kNumberOperations[operation].name, operands_text(operation, operands),
                                 format_name(format)),
            .expected = number_text(expected),
            .got = number_text(got)};
}

// Launches the kernel once with the rows of all operations. The kernel computes every operation for every row; each
// operation is compared only in its own rows.
Verdict check_answers(Session& session, const NumberBuild& build, const FormatAnswers& answers) {
    NumberRows rows;
    std::vector<ExpectedNumbers> expected;
    for (std::size_t k = 0; k < answers.operations.size(); ++k) {
        expected.push_back({.operation = k, .first_row = rows.count()});
        for (const KnownAnswer& answer : answers.operations[k]) {
            const auto operand = [&](std::size_t i) { return std::bit_cast<float>(answer.operands[i]); };
            rows.add(operand(0), operand(1), operand(2));
            expected.back().results.push_back(answer.result);
            expected.back().flushed.push_back(answer.flushed);
        }
    }
    rows.pad();
    return check_numbers(session, build, rows, expected);
}

void verify_format(Verification& v, const FormatAnswers& answers, std::uint32_t lanes, bool trusted,
                   bool optimised = true) {
    const NumberBuild build{.format = answers.format,
                            .lanes = lanes,
                            .trusted = trusted,
                            .imprecise = !trusted && v.device().correctly_rounded_divide_sqrt,
                            .optimised = optimised,
                            .sources = v.settings().sources};
    const bool promises_rounding = v.device().correctly_rounded_divide_sqrt || v.device().fused_multiply_add;
    v.check("number", build.name() + (trusted ? v.lanes_text(lanes) : ""), [&](Session& session) {
        if (!trusted && !promises_rounding)
            return skipped("the other checks run this code: the device promises no exact arithmetic");
        return check_answers(session, build, answers);
    });
}

// Returns the result of one work-item and lane of kernels/number/operations.cl in fp32.
float result_of_chains(std::size_t kind, std::uint32_t rounds, float x) {
    float sum = 0;
    for (int k = 0; k < RAYA_CHAINS; ++k) {
        float a = x + static_cast<float>(k);
        for (std::uint32_t i = 0; i < rounds; ++i) {
            const std::array<float, kOperations.size()> next = {x - a, a * x, std::fma(a, x * 0.5F, x), x / a,
                                                                std::sqrt(a)};
            a = next[kind];
        }
        sum += a;
    }
    return sum;
}

// Checks the results of the kernel that measures rates of operations.
Verdict check_chains(Session& session, const KernelOptions& options, const KernelSources& sources) {
    constexpr std::uint32_t kGroups = 3, kRounds = 5;
    constexpr float kStart = 1.25F;
    CheckRunner runner(session, Kernels(session, options, sources).program("number/operations.cl"));
    for (std::size_t kind = 0; kind < kOperations.size(); ++kind) {
        auto results = runner.constant("results", kGroups * options.lanes, -1.0F);
        runner.run<cl_uint, cl_uint, float, Buffer<float>&>("operations", kGroups, 1, static_cast<cl_uint>(kind),
                                                            kRounds, kStart, results);
        const float expected = result_of_chains(kind, kRounds, kStart);
        for (const float got : runner.read(results))
            if (got != expected)
                return failed(fmt::format("a chain of {} is wrong", kOperations[kind]),
                              {.where = fmt::format("{} from {}, {} times", kOperations[kind], kStart, kRounds),
                               .expected = fmt::format("{:.9g}", expected),
                               .got = fmt::format("{:.9g}", got),
                               .options = runner.options()});
    }
    return passed(fmt::format("{} operations", kOperations.size()));
}

// Returns true for a few formats that together cover every code path of the number layer: fp32, reduced formats with
// fewer exponent bits than fp32, reduced formats with 8 exponent bits as in fp32, and both kinds of rounding.
bool is_representative(const NumberFormat& format) {
    const auto names = {"fp32", "e6m15", "e6m15t", "e5m10", "e8m12", "e8m21t"};
    return std::ranges::find(names, format_name(format)) != names.end();
}

}  // namespace

void NumberRows::add(float x, float y, float z) {
    a.push_back(x);
    b.push_back(y);
    c.push_back(z);
}

void NumberRows::pad() {
    while (count() % kMaxLanes != 0) add(1, 1, 1);
}

std::string NumberBuild::name() const {
    return fmt::format("{}{}{}", format_name(format), trusted ? "" : ", fallback code",
                       optimised ? "" : ", -cl-opt-disable");
}

CheckRunner number_runner(Session& session, const NumberBuild& build) {
    const KernelOptions options{
        .lanes = build.lanes, .format = build.format, .exact_divide = build.trusted, .exact_fma = build.trusted};
    KernelSources sources = build.sources;
    if (!build.optimised) sources.more_options.emplace_back("-cl-opt-disable");
    if (!build.trusted) sources.more_options.emplace_back(kNoBuiltins);
    if (build.imprecise) {
        // The simulated errors are added to the device's results, which are not exact without this option (NVIDIA).
        sources.more_options.emplace_back("-cl-fp32-correctly-rounded-divide-sqrt");
        sources.more_options.emplace_back("-DRAYA_IMPRECISE=1");
    }
    return {session, Kernels(session, options, sources).program("checks/numbers.cl"), build.lanes};
}

NumberResults run_numbers(CheckRunner& runner, const NumberRows& rows) {
    std::vector<float> operands = rows.a;
    operands.insert(operands.end(), rows.b.begin(), rows.b.end());
    operands.insert(operands.end(), rows.c.begin(), rows.c.end());
    const auto operand_buffer = runner.filled("operands", operands);
    auto result_buffer = runner.poisoned("results", std::size(kNumberOperations) * rows.count());
    runner.run_rows<const Buffer<float>&, cl_uint, Buffer<std::uint32_t>&>(
        "operations", rows.count(), operand_buffer, static_cast<cl_uint>(rows.count()), result_buffer);
    const std::vector<std::uint32_t> columns = runner.read(result_buffer);
    NumberResults results;
    for (auto column = columns.begin(); column != columns.end(); column += std::ptrdiff_t(rows.count()))
        results.emplace_back(column, column + std::ptrdiff_t(rows.count()));
    return results;
}

Verdict check_numbers(Session& session, const NumberBuild& build, const NumberRows& rows,
                      const std::vector<ExpectedNumbers>& expected) {
    CheckRunner runner = number_runner(session, build);
    const NumberResults results = run_numbers(runner, rows);
    KnownWords known(results.size() * rows.count());
    std::size_t wrong = 0, compared = 0, kept = 0, flushed = 0;
    std::string operations;
    Fault fault;
    for (const ExpectedNumbers& answers : expected) {
        std::size_t wrong_of_operation = 0;
        for (std::size_t i = 0; i < answers.results.size(); ++i) {
            const std::size_t row = answers.first_row + i;
            const std::uint32_t got = results[answers.operation].at(row), correct = answers.results[i];
            const std::uint32_t zeroed =
                answers.flushed.empty() || session.device().denormals ? correct : answers.flushed[i];
            const bool may_flush = !agrees(zeroed, correct), keeps = agrees(got, correct);
            const bool flushes = may_flush && (agrees(got, zeroed) || (is_zero(got) && is_zero(zeroed)));
            ++compared;
            kept += may_flush && keeps;
            flushed += flushes && !keeps;
            known.set(answers.operation * rows.count() + row, flushes ? got : correct, is_nan(correct));
            if (keeps || flushes) continue;
            if (wrong++ == 0) fault = fault_of(build.format, answers.operation, rows, row, correct, got);
            ++wrong_of_operation;
        }
        if (wrong_of_operation)
            operations +=
                fmt::format("{}{} {} of {}", operations.empty() ? "" : ", ", kNumberOperations[answers.operation].name,
                            wrong_of_operation, answers.results.size());
    }
    if (wrong) {
        report_expected("results", known);
        return with_options(failed("wrong: " + operations, fault), runner.options());
    }
    const std::string denormals =
        kept + flushed ? fmt::format(", denormal numbers {} times kept, {} times flushed", kept, flushed) : "";
    return passed(fmt::format("{} answers{}", compared, denormals));
}

// --- Checks of layer "number": compare all operations in all formats with the known answers

void verify_numbers(Verification& v) {
    for (const FormatAnswers& answers : known_answers()) {
        if (!v.full() && !is_representative(answers.format)) continue;
        for (const std::uint32_t lanes : v.lanes()) {
            verify_format(v, answers, lanes, true);
            // Without the optimiser, vectors are passed to functions: PoCL 7.1 loses half of each (docs/defects.md).
            if (v.full() && answers.format.is_fp32()) verify_format(v, answers, lanes, true, false);
        }
        if (v.full()) verify_format(v, answers, v.lanes_or_default(), false);
    }
    const KernelOptions options{.lanes = v.lanes_or_default()};
    if (v.full())
        v.check("number", "chains of bench, fp32",
                [&](Session& session) { return check_chains(session, options, v.settings().sources); });
}

std::vector<FormatAnswers> parse_known_answers(const std::string& text) {
    constexpr std::uint32_t kOne = 0x3f800000;  // 1.0f
    std::vector<FormatAnswers> all;
    std::size_t operation = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream in(line);
        const std::vector<std::string> fields{std::istream_iterator<std::string>(in), {}};
        // The name of a format contains a letter that is not a hexadecimal digit: the p of "fp32" or the m of "eXmY".
        if (fields.at(0).find_first_of("mp") != std::string::npos) {
            const NumberFormat format = parse_format(fields[0]);
            if (all.empty() || all.back().format != format) all.push_back({format, {}});
            operation = static_cast<std::size_t>(
                std::ranges::find(kNumberOperations, fields.at(1), &NumberOperation::name) - kNumberOperations);
            continue;
        }
        std::vector<KnownAnswer>& answers = all.back().operations.at(operation);
        const std::size_t operands = kNumberOperations[operation].operands;
        KnownAnswer answer{{kOne, kOne, kOne}, word_of(fields.at(operands)), word_of(fields.back())};
        for (std::size_t k = 0; k < operands; ++k) answer.operands[k] = word_of(fields[k]);
        answers.push_back(answer);
    }
    return all;
}

const std::vector<FormatAnswers>& known_answers() {
    static const std::vector<FormatAnswers> all =
        parse_known_answers(embedded_files().at("host/verify/known_answers.csv"));
    return all;
}

}  // namespace raya
