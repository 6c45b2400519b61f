// The errors of x^n, log2(x) and 2^y are within the bounds of kernels/number/README.md, and results have the same bits
// in all builds.
#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "tests/number/mpfr_oracle.hpp"
#include "tests/number/number_runs.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kPowerSeed = 5;
constexpr std::size_t kPowerRows = 8000;
constexpr std::array<std::size_t, 3> kFunctions = {kPower, kLog2, kExp2};  // x^n, log2(x), 2^y of a row x, n, y

double result_of(const NumberResults& results, std::size_t operation, std::size_t row) {
    return std::bit_cast<float>(results[operation][row]);
}

/// Returns rows x, n, y. x is in (0, 4), and a third of the x are just below 1. n is in [0, 1024) or, in fp32, up to
/// 131,072, and many n are small. y is in [-126, 0].
NumberRows power_rows(const NumberFormat& format) {
    SplitMix random(kPowerSeed);
    const double smallest = std::ldexp(1, range_of(format).lowest);
    const auto in_format = [&](double value) { return round_to_format(value, format); };
    NumberRows rows;
    for (const float n : {0.0F, 1.0F, 8.0F}) rows.add(1, n, -n);
    for (const float x : {0.5F, 2.0F, in_format(smallest)}) rows.add(x, 0, -0.5F);
    while (rows.count() < kPowerRows) {
        const double below_one = 1 - std::exp2(random.uniform(-format.fraction_bits - 1, 0));
        const double x = rows.count() % 3 == 0 ? below_one : std::exp2(random.uniform(range_of(format).lowest, 2));
        const double n = std::exp2(random.uniform(-3, format.is_fp32() ? 17 : 10));
        const double y = random.uniform(rows.count() % 2 == 0 ? -30 : -126, 0);
        rows.add(in_format(std::max(x, smallest)), in_format(n), in_format(y));
    }
    rows.pad();
    return rows;
}

/// The error bounds of kernels/number/README.md, section Powers.
class PowerBounds {
  public:
    explicit PowerBounds(const NumberFormat& format)
        : unit_(std::ldexp(1, format.truncates ? -format.fraction_bits : -format.fraction_bits - 1)),
          flush_(std::ldexp(1, range_of(format).lowest)) {}

    double log(double value) const { return (gamma(7) + kLogSeries) * std::abs(value) + 6 * flush_; }
    double exp(double y) const { return (gamma(5) + kExpSeries) * std::exp2(y) + 2 * flush_; }
    /// Returns the error bound of n log2(x), which includes the errors of log2(x) and of the rounded product.
    double exponent(double n, double log_x) const {
        return (gamma(8) + kLogSeries) * std::abs(n * log_x) + (7 * n + 1) * flush_;
    }

  private:
    // Returns the maximum difference from 1 of a product of k factors 1 + d with |d| <= unit_ (N. J. Higham, Accuracy
    // and Stability of Numerical Algorithms, 3.1).
    double gamma(int k) const { return k * unit_ / (1 - k * unit_); }

    static constexpr double kLogSeries = 2.5e-7, kExpSeries = 2.4e-7;
    double unit_, flush_;
};

void check_row(const PowerBounds& bounds, double x, double n, double y, const NumberResults& results, std::size_t i) {
    // value(0), value(1), value(2): x^n, log2(x), 2^y
    const auto value = [&](std::size_t k) { return result_of(results, kFunctions[k], i); };
    const double log_x = std::log2(x), exponent = n * std::min(log_x, 0.0);
    CAPTURE(x, n, y, value(0), value(1), value(2));
    CHECK(std::abs(value(1) - log_x) <= bounds.log(log_x));
    CHECK(std::abs(value(2) - std::exp2(y)) <= bounds.exp(y));
    const double y_error = bounds.exponent(n, std::min(log_x, 0.0));
    const double min_value = std::exp2(exponent - y_error), max_value = std::exp2(exponent + y_error);
    CHECK(value(0) <= max_value + bounds.exp(exponent + y_error));
    if (exponent - y_error > -30) CHECK(value(0) >= min_value - bounds.exp(exponent - y_error));
    if (exponent + y_error < -30) CHECK(value(0) == 0);  // below 2^-30 a power is 0
    if (x >= 1 || n == 0) CHECK(value(0) == 1);
    if (x == 1) CHECK(value(1) == 0);
    if (y == 0) CHECK(value(2) == 1);
}

}  // namespace

TEST_CASE("powers stay within their error bounds, with the same bits in all builds", "[number][power]") {
    const NumberFormat formats[] = {{}, {5, 4, true}, {8, 5, true}, {6, 15, false}, {6, 15, true}, {8, 21, false}};
    for (const NumberFormat& format : formats) {
        const std::vector<NumberBuild> builds =
            format.is_fp32() ? fp32_builds() : std::vector{number_build(format), number_build(format, 1)};
        const NumberRows rows = power_rows(format);
        const NumberResults first = run_numbers(builds[0], rows);
        for (const NumberBuild& build : builds) {
            CAPTURE(build.name(), kPowerSeed);
            const NumberResults results = run_numbers(build, rows);
            for (const std::size_t function : kFunctions) CHECK(results[function] == first[function]);
        }
        const PowerBounds bounds(format);
        for (std::size_t i = 0; i < rows.count(); ++i) check_row(bounds, rows.a[i], rows.b[i], rows.c[i], first, i);
    }
}

}  // namespace raya
