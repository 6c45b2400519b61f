// x^n, log2 and 2^y in the reduced formats keep the errors that kernels/number/README.md derives, whatever the lanes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "tests/number/compare.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr std::size_t kRows = 8000;

/// x in (0, 4), a third of them crowded below 1; n in [0, 1000), many small; y in [-126, 0].
Operands power_operands(const NumberFormat& format) {
    SplitMix random(kSeed);
    const double smallest = std::ldexp(1, range_of(format).lowest);
    const auto in_format = [&](double value) { return round_to_format(value, format); };
    Operands operands;
    for (const float n : {0.0F, 1.0F, 8.0F}) operands.add(1, n, -n);
    for (const float x : {0.5F, 2.0F, in_format(smallest)}) operands.add(x, 0, -0.5F);
    while (operands.rows() < kRows) {
        const double crowded = 1 - std::exp2(random.uniform(-format.fraction_bits - 1, 0));
        const double x = operands.rows() % 3 == 0 ? crowded : std::exp2(random.uniform(range_of(format).lowest, 2));
        const double n = std::exp2(random.uniform(-3, 10));
        const double y = random.uniform(operands.rows() % 2 == 0 ? -30 : -126, 0);
        operands.add(in_format(std::max(x, smallest)), in_format(n), in_format(y));
    }
    operands.pad();
    return operands;
}

/// The bounds of kernels/number/README.md, "Powers".
class PowerBounds {
  public:
    explicit PowerBounds(const NumberFormat& format)
        : unit_(std::ldexp(1, format.truncates ? -format.fraction_bits : -format.fraction_bits - 1)),
          flush_(std::ldexp(1, range_of(format).lowest)) {}

    double log(double value) const { return (gamma(7) + kLogSeries) * std::abs(value) + 6 * flush_; }
    double exp(double y) const { return (gamma(5) + kExpSeries) * std::exp2(y) + 2 * flush_; }
    /// Of n log2(x), where log2 errs as above and the product is rounded.
    double exponent(double n, double log_x) const {
        return (gamma(8) + kLogSeries) * std::abs(n * log_x) + (7 * n + 1) * flush_;
    }

  private:
    // What k factors 1 + d, |d| <= unit, differ from 1 (N. J. Higham, Accuracy and Stability of Numerical
    // Algorithms, 3.1).
    double gamma(int k) const { return k * unit_ / (1 - k * unit_); }

    static constexpr double kLogSeries = 2.5e-7, kExpSeries = 2.4e-7;
    double unit_, flush_;
};

const std::vector<NumberFormat>& power_formats() {
    static const std::vector<NumberFormat> formats = {
        {5, 4, true}, {8, 5, true}, {6, 15, false}, {6, 15, true}, {8, 21, false}};
    return formats;
}

void check_row(const PowerBounds& bounds, double x, double n, double y, const Results& results, std::size_t i) {
    const auto value = [&](std::size_t k) { return static_cast<double>(std::bit_cast<float>(results[k][i])); };
    const double log_x = std::log2(x), exponent = n * std::min(log_x, 0.0);
    CAPTURE(x, n, y, value(0), value(1), value(2));
    CHECK(std::abs(value(1) - log_x) <= bounds.log(log_x));
    CHECK(std::abs(value(2) - std::exp2(y)) <= bounds.exp(y));
    const double off = bounds.exponent(n, std::min(log_x, 0.0));
    const double least = std::exp2(exponent - off), most = std::exp2(exponent + off);
    CHECK(value(0) <= most + bounds.exp(exponent + off));
    if (exponent - off > -30) CHECK(value(0) >= least - bounds.exp(exponent - off));
    if (exponent + off < -30) CHECK(value(0) == 0);  // below 2^-30 a power is 0
    if (x >= 1 || n == 0) CHECK(value(0) == 1);
    if (x == 1) CHECK(value(1) == 0);
    if (y == 0) CHECK(value(2) == 1);
}

}  // namespace

TEST_CASE("powers keep the errors that they state, the same bits for all lanes", "[number][power]") {
    for (const NumberFormat& format : power_formats()) {
        const Operands operands = power_operands(format);
        const NumberBuild build = {format};
        CAPTURE(build.name(), kSeed);
        const Results results = NumberRunner(build).run("powers", operands, 3);
        CHECK(NumberRunner({format, 1}).run("powers", operands, 3) == results);
        const PowerBounds bounds(format);
        for (std::size_t i = 0; i < operands.rows(); ++i)
            check_row(bounds, operands.a[i], operands.b[i], operands.c[i], results, i);
    }
}

}  // namespace raya
