// The number layer: IEEE's bits, truth by lanes, and the errors that its own functions state.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "tests/kernels/kernel_runner.hpp"

namespace raya {
namespace {

using Words = std::vector<std::uint32_t>;

/// Runs a kernel of numbers.cl on `operands`; gives `columns` words a row.
Words results_of(KernelRunner& runner, const std::string& kernel, const std::vector<float>& operands,
                 std::size_t operand_columns, std::size_t columns) {
    const std::size_t rows = operands.size() / operand_columns;
    const auto from = runner.filled("operands", operands);
    auto to = runner.constant<std::uint32_t>("results", rows * columns, 0);
    runner.run<const Buffer<float>&, Buffer<std::uint32_t>&>(kernel, rows, from, to);
    return runner.read(to);
}

/// Any sign and fraction, and an exponent from -40 to 40, so that no result leaves the normal range.
float random_float(SplitMix& random) {
    const std::uint64_t word = random.next();
    const auto exponent = static_cast<std::uint32_t>(127 - 40 + (word >> 32) % 81);
    return std::bit_cast<float>((static_cast<std::uint32_t>(word) & 0x807fffffu) | exponent << 23);
}

constexpr std::size_t kArithmeticColumns = 11;

/// What IEEE 754 says, from the host's arithmetic.
Words host_arithmetic(float a, float b, float c) {
    const float product = a * b;  // rounded on its own: the project builds without contraction
    const std::vector<float> results = {
        a + b,       a - b,         product,        a / b,      std::sqrt(std::abs(a)), std::fma(a, b, c), -a,
        std::abs(a), std::floor(a), std::max(a, b), product + c};
    Words words;
    for (const float result : results) words.push_back(std::bit_cast<std::uint32_t>(result));
    return words;
}

double real_of(std::uint32_t word) { return std::bit_cast<float>(word); }

/// [row][3]: x from 0x1p-126 to 2, crowded at 1; n of highlights; y from 0 to -126.
std::vector<float> power_operands() {
    std::vector<float> xs = {1, 2, std::nextafter(1.0F, 0.0F), std::sqrt(0.5F), 0x1p-126F, 1e-30F};
    for (int i = 1; i <= 500; ++i) xs.push_back(static_cast<float>(i) / 500);
    for (int i = 0; i <= 400; ++i) xs.push_back(static_cast<float>(1 - std::exp2(-24 + 0.06 * i)));  // crowded at 1
    for (int i = 0; i <= 400; ++i) xs.push_back(static_cast<float>(std::exp2(-0.3 * i)));
    while (xs.size() % 2 != 0) xs.push_back(1);
    const std::vector<float> ns = {0, 0.5F, 1, 3.08F, 11, 101.148F, 1000, 100'000};
    std::vector<float> operands;
    for (const float x : xs)
        for (const float n : ns) {
            const auto i = static_cast<double>(operands.size());
            for (const double value :
                 {double(x), double(n), -126 * i / (3.0 * static_cast<double>(xs.size() * ns.size()))})
                operands.push_back(static_cast<float>(value));
        }
    return operands;
}

}  // namespace

TEST_CASE("arithmetic gives the bits of IEEE 754", "[kernels]") {
    constexpr std::uint64_t kSeed = 61;
    constexpr std::size_t kRows = 100'000;
    SplitMix random(kSeed);
    std::vector<float> operands;
    for (std::size_t i = 0; i < 3 * kRows; ++i) operands.push_back(random_float(random));
    Words expected;
    for (std::size_t i = 0; i < kRows; ++i) {
        const Words row = host_arithmetic(operands[3 * i], operands[3 * i + 1], operands[3 * i + 2]);
        expected.insert(expected.end(), row.begin(), row.end());
    }
    for (const Variant& variant : variants()) {
        KernelRunner runner("numbers.cl", variant);
        const Words results = results_of(runner, "arithmetic", operands, 3, kArithmeticColumns);
        const auto [at, wanted] = std::mismatch(results.begin(), results.end(), expected.begin());
        const auto index = static_cast<std::size_t>(at - results.begin());
        const std::size_t row = std::min(index / kArithmeticColumns, kRows - 1);
        CAPTURE(variant.name(), kSeed, row, index % kArithmeticColumns, operands[3 * row], operands[3 * row + 1],
                operands[3 * row + 2]);
        CHECK(at == results.end());
    }
}

TEST_CASE("truth by lanes chooses, counts and is seen whichever lane has it", "[kernels]") {
    constexpr std::uint64_t kSeed = 62;
    constexpr std::size_t kColumns = 9;
    // Rows of 16: no lane true, all, each lane alone, each alone false, and random ones. True: a < b.
    SplitMix random(kSeed);
    std::vector<bool> truth(16, false);
    truth.insert(truth.end(), 16, true);
    for (std::size_t i = 0; i < 256; ++i) truth.push_back(i / 16 == i % 16);
    for (std::size_t i = 0; i < 256; ++i) truth.push_back(i / 16 != i % 16);
    for (std::size_t i = 0; i < 512; ++i) truth.push_back(random.next() >> 63);
    std::vector<float> operands;
    for (const bool is_true : truth) {
        operands.push_back(random_float(random));
        const float above = std::nextafter(operands.back(), HUGE_VALF);
        operands.push_back(is_true ? above : operands.back());  // equal is not less
    }
    for (const Variant& variant : variants()) {
        KernelRunner runner("numbers.cl", variant);
        const Words results = results_of(runner, "masks", operands, 2, kColumns);
        for (std::uint32_t i = 0; i < truth.size(); ++i) {
            const auto group = truth.begin() + i / variant.lanes * variant.lanes;
            const auto any = [&](bool value) {
                return std::find(group, group + variant.lanes, value) != group + variant.lanes;
            };
            const Words expected = {
                std::bit_cast<std::uint32_t>(operands[2 * i]),  // a, which is b too where m is false
                truth[i] ? i : 12345u,
                i + truth[i],
                truth[i] ? i + 5 : i,
                any(true),
                any(false),
                truth[i],
                2,
                std::bit_cast<std::uint32_t>(static_cast<float>(i))};
            const Words row(results.begin() + i * kColumns, results.begin() + (i + 1) * kColumns);
            CAPTURE(variant.name(), kSeed, i);
            CHECK(row == expected);
        }
    }
}

TEST_CASE("powers, logarithms and exponentials keep the errors that they state", "[kernels]") {
    // num_log2: the series leaves 8e-8 of the result, the roundings 1.7e-7. num_exp2: its Taylor series leaves
    // (ln 2 / 2)^7 / 7! at f = -1/2, 1.7e-7 of the result, and the last additions 7e-8.
    constexpr double kLogError = 2.5e-7, kExpError = 2.4e-7;
    // The product n log2(x) is rounded too, so that 2^y is asked for at a y wrong by 3.1e-7 of it; the largest value of
    // |y| ln 2 2^y is 1 / e. What is below 2^-30 is 0.
    const double kPowerError = (kLogError + 0x1p-24) / std::exp(1.0) + kExpError + 0x1p-30;
    const std::vector<float> operands = power_operands();
    std::optional<Words> first;
    for (const Variant& variant : variants()) {
        CAPTURE(variant.name());
        KernelRunner runner("numbers.cl", variant);
        const Words results = results_of(runner, "powers", operands, 3, 3);
        if (!first) first = results;
        CHECK(results == *first);
    }
    for (std::size_t i = 0; i < first->size(); i += 3) {
        const double x = operands[i], n = operands[i + 1], y = operands[i + 2];
        const double power = real_of((*first)[i]), log = real_of((*first)[i + 1]), exp = real_of((*first)[i + 2]);
        CAPTURE(x, n, y, power, log, exp);
        CHECK(std::abs(power - std::pow(std::min(x, 1.0), n)) <= kPowerError);
        CHECK(std::abs(log - std::log2(x)) <= kLogError * std::abs(std::log2(x)));
        CHECK(std::abs(exp - std::exp2(y)) <= kExpError * std::exp2(y));
        if (n == 0 || x >= 1) CHECK(power == 1);
    }
}

}  // namespace raya
