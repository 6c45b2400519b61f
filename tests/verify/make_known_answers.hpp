// Makes the known answers of the number layer. Operands are selected so that every operation has rows with every
// rounding feature; results are from MPFR.
#pragma once
#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "host/verify/numbers.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"
#include "tests/verify/exact_value.hpp"

namespace raya {

/// Feature of rows that another method would change: fused or unfused a b + c, or a quotient by the reciprocal.
inline constexpr const char* kOtherMethod = "another method is wrong";

/// The operations by an oracle, with the features of their results. Oracle: MpfrOracle, or IeeeOracle for fp32.
template <class Oracle>
class AnswerMaker {
  public:
    AnswerMaker(Oracle& oracle, const NumberFormat& format) : oracle_(oracle), format_(format) {}

    float result(std::size_t operation, float a, float b, float c) {
        return operation == kPower ? power(a, b) : oracle_result(oracle_, operation, a, b, c);
    }

    /// Returns the features of this row; rows with the same features are redundant.
    std::set<std::string> features(std::size_t operation, float a, float b, float c) {
        const float expected = result(operation, a, b, c);
        exact(operation, a, b, c);
        std::set<std::string> all = features_of(exact_, expected, format_);
        // Methods that a compiler or device may use instead of the operation.
        if ((operation == kMad || operation == kMulAdd) &&
            differ(oracle_.mad(a, b, c), oracle_.add(oracle_.mul(a, b), c)))
            all.insert(kOtherMethod);
        if (operation == kDiv && differ(expected, oracle_.mul(a, oracle_.div(1, b)))) all.insert(kOtherMethod);
        const double largest = format_.is_fp32() ? INFINITY : largest_number();
        if (std::abs(expected) == largest) all.insert(std::signbit(expected) ? "largest -" : "largest +");
        if (std::fpclassify(expected) == FP_SUBNORMAL) all.insert("denormal");
        if (std::abs(expected) == std::ldexp(1.0, range_of(format_).lowest)) all.insert("smallest");
        return all;
    }

  private:
    static bool differ(float a, float b) { return !std::isnan(a) && !std::isnan(b) && a != b; }

    double largest_number() const {
        return std::ldexp(2 - std::ldexp(1.0, -format_.fraction_bits), range_of(format_).highest);
    }

    // Sets exact_ to the exact value of operations with one rounding, to the result of others.
    void exact(std::size_t operation, float a, float b, float c) {
        Mpfr x(24), y(24), z(24);
        mpfr_set_flt(x, a, MPFR_RNDN);
        mpfr_set_flt(y, b, MPFR_RNDN);
        mpfr_set_flt(z, c, MPFR_RNDN);
        if (operation == kAdd)
            mpfr_add(exact_, x, y, MPFR_RNDZ);
        else if (operation == kSub)
            mpfr_sub(exact_, x, y, MPFR_RNDZ);
        else if (operation == kMul)
            mpfr_mul(exact_, x, y, MPFR_RNDZ);
        else if (operation == kDiv)
            mpfr_div(exact_, x, y, MPFR_RNDZ);
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

    // The operations of kernels/number/power.clh in the same order.
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

    Oracle& oracle_;
    NumberFormat format_;
    Mpfr exact_{kExactBits};
};

/// Special numbers of the format, of either sign: ends of the range, neighbours of 1, ...
inline std::vector<float> special_numbers(const NumberFormat& format) {
    const Range range = range_of(format);
    const double unit = std::ldexp(1.0, -format.fraction_bits), base = std::ldexp(1.0, range.highest - 1);
    const double smallest = std::ldexp(1.0, range.lowest), step = base * unit;
    const double positive[] = {0,
                               1,
                               1 + unit,
                               1 - unit / 2,
                               1.5,
                               2.25,
                               3,
                               base,
                               base + step,
                               step / 2,
                               step * 2,
                               smallest,
                               smallest * 1.5,
                               smallest * (1 + unit),
                               step / 4 * (2 - unit),
                               base * (2 - unit),
                               2 * base * (2 - unit)};
    std::vector<float> all;
    for (const double value : positive)
        for (const int sign : {1, -1}) all.push_back(static_cast<float>(sign * value));
    if (format.is_fp32())
        for (const float value : {0x1p-149F, -0x1.8p-140F, 0x1.fffffcp-127F, INFINITY, -INFINITY}) all.push_back(value);
    return all;
}

/// Candidate operands: [row][3].
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
    if (operation == kPower) {
        for (const float x : {1.0F, 0.75F, 0.0078125F, 2.0F})
            for (const float n : {0.0F, 1.0F, 50.0F}) all.push_back({x, n, 1});
        const auto rounded = [&](double value) {
            return format.is_fp32() ? static_cast<float>(value) : round_to_format(value, format);
        };
        for (int i = 0; i < 8; ++i)
            all.push_back({rounded(1 - std::ldexp(random.uniform(0, 1), -i)), rounded(random.uniform(1, 30)), 1});
        return all;
    }
    // Random operands first: they have more features; special numbers add the missing ones.
    const NumberFormat operand_format =
        operation == kRound ? NumberFormat{} : format;  // num_round takes any fp32 number
    const NumberRows rows = RandomOperands(operand_format, kSeed).rows(kRandomRows);
    for (std::size_t i = 0; i < rows.count(); ++i) all.push_back({rows.a[i], rows.b[i], rows.c[i]});
    const std::vector<float> marks = special_numbers(format);
    for (const float a : marks)
        for (const float b : marks)
            for (const float c : {1.0F, -a, b, marks[all.size() % marks.size()]}) all.push_back({a, b, c});
    return all;
}

/// The rows of one operation: the first candidates with each feature, until each occurs twice (some six times).
template <class Oracle>
std::vector<KnownAnswer> choose_answers(AnswerMaker<Oracle>& maker, std::size_t operation, const NumberFormat& format) {
    const auto enough = [](const std::string& feature) { return feature == kOtherMethod || feature == kTwice ? 6 : 2; };
    const std::size_t operands = kNumberOperations[operation].operands;
    std::map<std::string, int> seen;
    std::set<std::array<std::uint32_t, 3>> taken;
    std::vector<KnownAnswer> answers;
    for (auto [a, b, c] : candidates(operation, format)) {
        // num_round takes normal numbers and zeros only.
        if (operation == kRound && (std::fpclassify(a) == FP_SUBNORMAL || std::isinf(a))) continue;
        if (operands < 2) b = 1;
        if (operands < 3) c = 1;
        bool wanted = operation == kPower;  // all candidates of num_power
        const std::set<std::string> features = maker.features(operation, a, b, c);
        for (const std::string& feature : features) wanted = wanted || seen[feature] < enough(feature);
        const std::array<std::uint32_t, 3> bits = {std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b),
                                                   std::bit_cast<std::uint32_t>(c)};
        if (!wanted || !taken.insert(bits).second) continue;
        for (const std::string& feature : features) ++seen[feature];
        float result = maker.result(operation, a, b, c);
        if (std::isnan(result)) result = std::bit_cast<float>(0x7fc00000u);  // one NaN for all
        answers.push_back({bits, std::bit_cast<std::uint32_t>(result)});
    }
    return answers;
}

template <class Oracle>
FormatAnswers answers_by(Oracle& oracle, const NumberFormat& format) {
    AnswerMaker<Oracle> maker(oracle, format);
    FormatAnswers all{format, {}};
    for (std::size_t k = 0; k < kAnsweredOperations; ++k) all.operations[k] = choose_answers(maker, k, format);
    return all;
}

inline FormatAnswers answers_in(const NumberFormat& format) {
    if (format.is_fp32()) {
        IeeeOracle oracle;
        return answers_by(oracle, format);
    }
    MpfrOracle oracle(format);
    return answers_by(oracle, format);
}

/// The text of host/verify/known_answers.csv: a format for each variant of the number layer, and more.
inline std::string make_known_answers() {
    std::vector<FormatAnswers> all;
    for (const char* name :
         {"fp32", "e5m4", "e5m10", "e5m10t", "e6m15", "e6m15t", "e7m12", "e8m12", "e8m12t", "e8m21", "e8m21t"})
        all.push_back(answers_in(parse_format(name)));
    return known_answers_text(all);
}

}  // namespace raya
