// Makes the known answers of the number layer: operands chosen so that every operation meets everything that is
// remarkable about rounding, results from MPFR.
#pragma once
#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "host/verify/known_answers.hpp"
#include "tests/number/random_operands.hpp"
#include "tests/verify/exact_value.hpp"

namespace raya {

/// The feature of rows that are wrong where a b + c is fused or is not, or where a quotient is made by the reciprocal.
inline constexpr const char* kOtherWay = "another way is wrong";

/// The operations as functions of bits, by one of the oracles: MpfrOracle, or IeeeOracle for fp32.
template <class Oracle>
class AnswerMaker {
  public:
    AnswerMaker(Oracle& oracle, const NumberFormat& format) : oracle_(oracle), format_(format) {}

    /// The result of an operation of kVerifiedOperations.
    float result(const std::string& name, float a, float b, float c) {
        if (name == "add") return oracle_.add(a, b);
        if (name == "sub") return oracle_.sub(a, b);
        if (name == "mul") return oracle_.mul(a, b);
        if (name == "div") return oracle_.div(a, b);
        if (name == "sqrt") return oracle_.sqrt(a);
        if (name == "mad") return oracle_.mad(a, b, c);
        if (name == "mul_add") return oracle_.add(oracle_.mul(a, b), c);
        if (name == "max") return a > b ? a : b;
        if (name == "floor") return std::floor(a);
        if (name == "round") return oracle_.round(a);
        if (name == "from_index") return oracle_.round(std::bit_cast<std::uint32_t>(a));
        return power(a, b);
    }

    /// What is remarkable about this row; rows of the same features say the same.
    std::set<std::string> features(const std::string& name, float a, float b, float c) {
        const float expected = result(name, a, b, c);
        exact(name, a, b, c);
        std::set<std::string> all = features_of(exact_, expected, format_);
        // What a compiler or a device may do in place of the operation.
        if ((name == "mad" || name == "mul_add") && differ(oracle_.mad(a, b, c), oracle_.add(oracle_.mul(a, b), c)))
            all.insert(kOtherWay);
        if (name == "div" && differ(expected, oracle_.mul(a, oracle_.div(1, b)))) all.insert(kOtherWay);
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

    // The exact value of operations with one rounding; of the others, their result.
    void exact(const std::string& name, float a, float b, float c) {
        Mpfr x(24), y(24), z(24);
        mpfr_set_flt(x, a, MPFR_RNDN);
        mpfr_set_flt(y, b, MPFR_RNDN);
        mpfr_set_flt(z, c, MPFR_RNDN);
        if (name == "add")
            mpfr_add(exact_, x, y, MPFR_RNDZ);
        else if (name == "sub")
            mpfr_sub(exact_, x, y, MPFR_RNDZ);
        else if (name == "mul")
            mpfr_mul(exact_, x, y, MPFR_RNDZ);
        else if (name == "div")
            mpfr_div(exact_, x, y, MPFR_RNDZ);
        else if (name == "sqrt")
            mpfr_sqrt(exact_, x, MPFR_RNDZ);
        else if (name == "mad")
            mpfr_fma(exact_, x, y, z, MPFR_RNDZ);
        else if (name == "round")
            mpfr_set(exact_, x, MPFR_RNDZ);
        else if (name == "from_index")
            mpfr_set_ui(exact_, std::bit_cast<std::uint32_t>(a), MPFR_RNDZ);
        else
            mpfr_set_flt(exact_, result(name, a, b, c), MPFR_RNDZ);
    }

    // kernels/number/power.clh, operation by operation.
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

/// Numbers of the format at which something happens, of either sign.
inline std::vector<float> landmarks(const NumberFormat& format) {
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

/// Operands that may be worth a row: [row][3].
inline std::vector<std::array<float, 3>> candidates(const std::string& operation, const NumberFormat& format) {
    constexpr std::uint64_t kSeed = 19'930;
    constexpr std::size_t kRandomRows = 3000;
    std::vector<std::array<float, 3>> all;
    SplitMix random(kSeed);
    if (operation == "from_index") {
        const auto add = [&](std::uint32_t number) { all.push_back({std::bit_cast<float>(number), 1, 1}); };
        for (std::uint32_t bit = 1; bit < 1u << 24; bit *= 2)
            for (const std::uint32_t number : {bit - 1, bit, bit + 1, bit + bit / 2}) add(number);
        for (std::size_t i = 0; i < kRandomRows; ++i) add(static_cast<std::uint32_t>(random.next() >> 40));
        return all;
    }
    if (operation == "power") {
        for (const float x : {1.0F, 0.75F, 0.0078125F, 2.0F})
            for (const float n : {0.0F, 1.0F, 50.0F}) all.push_back({x, n, 1});
        const auto rounded = [&](double value) {
            return format.is_fp32() ? static_cast<float>(value) : round_to_format(value, format);
        };
        for (int i = 0; i < 8; ++i)
            all.push_back({rounded(1 - std::ldexp(random.uniform(0, 1), -i)), rounded(random.uniform(1, 30)), 1});
        return all;
    }
    // By lot first: their operands are richer than the landmarks, which have the features that are left.
    const NumberFormat drawn = operation == "round" ? NumberFormat{} : format;  // what is rounded is any fp32 number
    const Operands rows = RandomOperands(drawn, kSeed).rows(kRandomRows);
    for (std::size_t i = 0; i < rows.rows(); ++i) all.push_back({rows.a[i], rows.b[i], rows.c[i]});
    const std::vector<float> marks = landmarks(format);
    for (const float a : marks)
        for (const float b : marks)
            for (const float c : {1.0F, -a, b, marks[all.size() % marks.size()]}) all.push_back({a, b, c});
    return all;
}

/// The rows of one operation: the first candidates with which each feature is there twice, and some more.
template <class Oracle>
std::vector<KnownAnswer> choose_answers(AnswerMaker<Oracle>& maker, std::size_t operation, const NumberFormat& format) {
    const auto enough = [](const std::string& feature) { return feature == kOtherWay || feature == kTwice ? 6 : 2; };
    const VerifiedOperation& op = kVerifiedOperations[operation];
    std::map<std::string, int> seen;
    std::set<std::array<std::uint32_t, 3>> taken;
    std::vector<KnownAnswer> answers;
    for (auto [a, b, c] : candidates(op.name, format)) {
        // num_round is for normal numbers and zeros.
        if (std::string(op.name) == "round" && (std::fpclassify(a) == FP_SUBNORMAL || std::isinf(a))) continue;
        if (op.operands < 2) b = 1;
        if (op.operands < 3) c = 1;
        bool wanted = op.name == std::string("power");  // all: its candidates are chosen
        const std::set<std::string> features = maker.features(op.name, a, b, c);
        for (const std::string& feature : features) wanted = wanted || seen[feature] < enough(feature);
        const std::array<std::uint32_t, 3> bits = {std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b),
                                                   std::bit_cast<std::uint32_t>(c)};
        if (!wanted || !taken.insert(bits).second) continue;
        for (const std::string& feature : features) ++seen[feature];
        float result = maker.result(op.name, a, b, c);
        if (std::isnan(result)) result = std::bit_cast<float>(0x7fc00000u);  // one NaN for all
        answers.push_back({bits, std::bit_cast<std::uint32_t>(result)});
    }
    return answers;
}

template <class Oracle>
FormatAnswers answers_by(Oracle& oracle, const NumberFormat& format) {
    AnswerMaker<Oracle> maker(oracle, format);
    FormatAnswers all{format, {}};
    for (std::size_t k = 0; k < kVerifiedOperations.size(); ++k) all.operations[k] = choose_answers(maker, k, format);
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

/// The text of host/verify/known_answers.csv: a format for each way of the layer and more.
inline std::string make_known_answers() {
    std::vector<FormatAnswers> all;
    for (const char* name :
         {"fp32", "e5m4", "e5m10", "e5m10t", "e6m15", "e6m15t", "e7m12", "e8m12", "e8m12t", "e8m21", "e8m21t"})
        all.push_back(answers_in(parse_format(name)));
    return known_answers_text(all);
}

}  // namespace raya
