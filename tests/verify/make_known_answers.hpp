// Makes the known answers of the number layer: rows with an operation, its operands, and the result that MPFR computes.
// The operands are selected so that the rows of each operation cover every rounding feature.
#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "host/verify/numbers.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"
#include "tests/verify/digits.hpp"
#include "tests/verify/exact_value.hpp"

namespace raya {

/// Feature of a row whose result would differ with another method. For a * b + c the other method is unfused instead of
/// fused, or the reverse; for a division it is the multiplication by the reciprocal.
inline constexpr const char* kOtherMethod = "another method is wrong";

/// Computes operations, and the rounding features of the results. `flushes`: as for MpfrOracle.
class AnswerMaker {
  public:
    explicit AnswerMaker(const NumberFormat& format, bool flushes = false)
        : oracle_(format, flushes), format_(format) {}

    float result(std::size_t operation, float a, float b, float c) {
        switch (operation) {
            case kPower:
                return power(a, b);
            case kLog2:
                return log2(a);
            case kExp2:
                return exp2(c);
            default:
                return oracle_result(oracle_, operation, a, b, c);
        }
    }

    /// Returns the features of the row with these operands. Rows with the same features are redundant.
    std::set<std::string> features(std::size_t operation, float a, float b, float c) {
        const float expected = result(operation, a, b, c);
        set_exact(operation, a, b, c);
        std::set<std::string> features = features_of(exact_, expected, format_);
        // Other methods that a compiler or device may use for the operation.
        if ((operation == kMad || operation == kMulAdd) &&
            differ(oracle_.mad(a, b, c), oracle_.add(oracle_.mul(a, b), c)))
            features.insert(kOtherMethod);
        if (operation == kDiv && differ(expected, oracle_.mul(a, oracle_.div(1, b)))) features.insert(kOtherMethod);
        if (operation == kMax && a == b && std::signbit(a) != std::signbit(b)) features.insert("zeros of both signs");
        // Kernels scale such an operand before they compute the rounding error of the root.
        if (operation == kSqrt && a < 0x1p-100F && features.contains(kDoubleRounding))
            features.insert("scaled operand");
        const double largest = format_.is_fp32() ? INFINITY : largest_number();
        if (std::abs(expected) == largest) features.insert(std::signbit(expected) ? "largest -" : "largest +");
        if (std::fpclassify(expected) == FP_SUBNORMAL) features.insert("denormal");
        if (std::abs(expected) == std::ldexp(1.0, range_of(format_).lowest)) features.insert("smallest");
        return features;
    }

  private:
    static bool differ(float a, float b) { return !std::isnan(a) && !std::isnan(b) && a != b; }

    double largest_number() const {
        return std::ldexp(2 - std::ldexp(1.0, -format_.fraction_bits), range_of(format_).highest);
    }

    // Sets exact_ to the exact value if the operation rounds once, otherwise to the operation's result.
    void set_exact(std::size_t operation, float a, float b, float c) {
        Mpfr x(24), y(24), z(24);
        mpfr_set_flt(x, a, MPFR_RNDN);
        mpfr_set_flt(y, b, MPFR_RNDN);
        mpfr_set_flt(z, c, MPFR_RNDN);
        constexpr auto kBinary = std::array{mpfr_add, mpfr_sub, mpfr_mul, mpfr_div};  // from kAdd on
        if (operation <= kDiv)
            kBinary[operation](exact_, x, y, MPFR_RNDZ);
        else if (operation == kSqrt)
            mpfr_sqrt(exact_, x, MPFR_RNDZ);
        else if (operation == kMad)
            mpfr_fma(exact_, x, y, z, MPFR_RNDZ);
        else if (operation == kRound)
            mpfr_set(exact_, x, MPFR_RNDZ);
        else if (operation == kFromIndex)
            mpfr_set_ui(exact_, std::bit_cast<std::uint32_t>(a), MPFR_RNDZ);
        else
            mpfr_set_flt(exact_, result(operation, a, b, c), MPFR_RNDZ);
    }

    // log2(), exp2() and power() do the same operations as kernels/number/power.clh, in the same order.
    float constant(float value) { return format_.is_fp32() ? value : round_to_format(value, format_); }
    float log2(float x) {
        const auto bits = std::bit_cast<std::int32_t>(x);
        const std::int32_t e = (bits - 0x3f3504f3) >> 23;
        const float m = std::bit_cast<float>(bits - static_cast<std::int32_t>(static_cast<std::uint32_t>(e) << 23));
        const float s = oracle_.div(oracle_.sub(m, constant(1)), oracle_.add(m, constant(1)));
        const float square = oracle_.mul(s, s);
        float series = oracle_.mad(square, constant(0x1.a61762p-2F), constant(0x1.2776c6p-1F));
        series = oracle_.mad(series, square, constant(0x1.ec709ep-1F));
        series = oracle_.mad(series, square, constant(0x1.715476p+1F));
        return oracle_.mad(series, s, oracle_.round(e));
    }
    float exp2(float y) {
        const float whole = std::floor(y + 0.5F), f = oracle_.sub(y, whole);
        float series = oracle_.mad(f, constant(0x1.430912p-13F), constant(0x1.5d87fep-10F));
        for (const float next : {0x1.3b2ab6p-7F, 0x1.c6b08ep-5F, 0x1.ebfbep-3F, 0x1.62e43p-1F, 1.0F})
            series = oracle_.mad(series, f, constant(next));
        return oracle_.mul(series, std::ldexp(1.0F, static_cast<int>(whole)));
    }
    float power(float x, float n) {
        const float y = oracle_.mul(n, log2(x < 1 ? x : constant(1)));
        return y > -30 ? exp2(y) : constant(0);
    }

    MpfrOracle oracle_;
    NumberFormat format_;
    Mpfr exact_{kExactBits};
};

/// Returns special numbers of the format, with both signs, such as the ends of its range and the neighbours of 1.
inline std::vector<float> special_numbers(const NumberFormat& format) {
    const Range range = range_of(format);
    const double unit = std::ldexp(1.0, -format.fraction_bits), base = std::ldexp(1.0, range.highest - 1);
    const double smallest = std::ldexp(1.0, range.lowest), step = base * unit;
    std::vector<double> positive = {0, 1, 1 + unit, 1 - unit / 2, 1.5, 2.25, 3, base, base + step, step / 2, step * 2};
    for (const double factor : {1.0, 1.5, 1 + unit, 1 + 2 * unit, 1 + 3 * unit}) positive.push_back(smallest * factor);
    for (const double factor : {step / 4, base, 2 * base}) positive.push_back(factor * (2 - unit));
    std::vector<float> all;
    for (const double value : positive)
        for (const int sign : {1, -1}) all.push_back(static_cast<float>(sign * value));
    if (format.is_fp32())
        for (const float value : {0x1p-149F, -0x1.8p-140F, 0x1.fffffcp-127F, INFINITY, -INFINITY}) all.push_back(value);
    return all;
}

/// Returns candidate operands, three per row: [row][3].
inline std::vector<std::array<float, 3>> candidates(std::size_t operation, const NumberFormat& format) {
    constexpr std::uint64_t kSeed = 19'930;
    constexpr std::size_t kRandomRows = 3000;
    std::vector<std::array<float, 3>> all;
    SplitMix random(kSeed);
    if (operation == kFromIndex) {
        const auto add = [&](std::uint32_t number) { all.push_back({std::bit_cast<float>(number), 1, 1}); };
        for (std::uint32_t bit = 1; bit < 1u << 24; bit *= 2)
            for (const std::uint32_t number : {bit - 1, bit, bit + 1, bit + bit / 2}) add(number);
        for (std::size_t i = 0; i < kRandomRows; ++i) add(static_cast<std::uint32_t>(random.next() >> 40));
        return all;
    }
    // Rows x, n, y of x^n, log2(x) and 2^y.
    if (operation == kPower || operation == kLog2 || operation == kExp2) {
        const auto add = [&](float x, float n) { all.push_back({x, n, std::max(-n, -29.0F)}); };
        for (const float x : {1.0F, 0.75F, 0.0078125F, 2.0F})
            for (const float n : {0.0F, 1.0F, 50.0F}) add(x, n);
        // Near 0.71 the series of log2() is longest, and these two results depend on the last bits of its constants.
        if (format.is_fp32())
            for (const auto& [x, n] : {std::pair{0x1.6c4bbep-1F, 0x1.5468e6p+2F}, {0x1.777a48p-1F, 0x1.546ce2p+3F}})
                add(x, n);
        const auto rounded = [&](double value) {
            return format.is_fp32() ? static_cast<float>(value) : round_to_format(value, format);
        };
        for (int i = 0; i < 8; ++i)
            add(rounded(1 - std::ldexp(random.uniform(0, 1), -i)), rounded(random.uniform(1, 30)));
        return all;
    }
    // Random operands come first, because their rows have more features. Special numbers add the missing features.
    const NumberFormat operand_format =
        operation == kRound ? NumberFormat{} : format;  // the operand of num_round is an fp32 number
    const NumberRows rows = RandomOperands(operand_format, kSeed).rows(kRandomRows);
    for (std::size_t i = 0; i < rows.count(); ++i) all.push_back({rows.a[i], rows.b[i], rows.c[i]});
    const std::vector<float> specials = special_numbers(format);
    for (const float a : specials)
        for (const float b : specials)
            for (const float c : {1.0F, -a, b, specials[all.size() % specials.size()]}) all.push_back({a, b, c});
    return all;
}

/// Returns the rows of one operation: goes through the candidates in order, and keeps a candidate if one of its
/// features is in fewer than two rows so far (six for kOtherMethod and kDoubleRounding).
inline std::vector<KnownAnswer> choose_answers(std::size_t operation, const NumberFormat& format) {
    AnswerMaker maker(format), flushing_maker(format, true);
    const auto wanted_rows = [](const std::string& feature) {
        return feature == kOtherMethod || feature == kDoubleRounding ? 6 : 2;
    };
    const std::size_t operands = kNumberOperations[operation].operands;
    std::map<std::string, int> seen;
    std::set<std::array<std::uint32_t, 3>> used_operands;
    std::vector<KnownAnswer> answers;
    for (auto [a, b, c] : candidates(operation, format)) {
        // num_round accepts only normal numbers and zeros.
        if (operation == kRound && (std::fpclassify(a) == FP_SUBNORMAL || std::isinf(a))) continue;
        if (operands < 2) b = 1;
        if (operands < 3) c = 1;
        if (operation == kExp2) a = b = 1;
        bool wanted = operation == kPower || operation == kLog2 || operation == kExp2;  // all candidates are kept
        const std::set<std::string> features = maker.features(operation, a, b, c);
        for (const std::string& feature : features) wanted = wanted || seen[feature] < wanted_rows(feature);
        const std::array<std::uint32_t, 3> bits = {std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b),
                                                   std::bit_cast<std::uint32_t>(c)};
        if (!wanted || !used_operands.insert(bits).second) continue;
        for (const std::string& feature : features) ++seen[feature];
        const auto word = [](float result) {
            return std::isnan(result) ? 0x7fc00000u
                                      : std::bit_cast<std::uint32_t>(result);  // the same bits for every NaN
        };
        answers.push_back(
            {bits, word(maker.result(operation, a, b, c)), word(flushing_maker.result(operation, a, b, c))});
    }
    return answers;
}

inline FormatAnswers answers_in(const NumberFormat& format) {
    FormatAnswers all{format, {}};
    for (std::size_t k = 0; k < std::size(kNumberOperations); ++k) all.operations[k] = choose_answers(k, format);
    return all;
}

/// Inverse of parse_known_answers().
inline std::string known_answers_text(const std::vector<FormatAnswers>& all) {
    std::string text =
        R"(# Known answers of the number layer, made by tests/verify/make_known_answers.cpp with MPFR: do not edit.
# A line "FORMAT OPERATION" starts a section. Each further line has the bits of the operands, of the result
# and, if it differs, of the result of a device that replaces denormal operands and results by zeros:
# fp32 numbers in hexadecimal without trailing zeros.
)";
    for (const FormatAnswers& answers : all)
        for (std::size_t k = 0; k < std::size(kNumberOperations); ++k) {
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

/// Returns the text of host/verify/known_answers.csv. The text has at least one format for each code path of the number
/// layer.
inline std::string make_known_answers() {
    std::vector<FormatAnswers> all;
    for (const char* name :
         {"fp32", "e5m4", "e5m10", "e5m10t", "e6m15", "e6m15t", "e7m12", "e8m12", "e8m12t", "e8m21", "e8m21t"})
        all.push_back(answers_in(parse_format(name)));
    return known_answers_text(all);
}

}  // namespace raya
