// Computes expected results of operations with an oracle, such as MpfrOracle or HostOracle.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "host/verify/numbers.hpp"
#include "tests/number/mpfr_oracle.hpp"

namespace raya {

/// The oracle of fp32: the host's arithmetic. The project is compiled without contraction to fma.
struct HostOracle {
    float add(float a, float b) const { return a + b; }
    float sub(float a, float b) const { return a - b; }
    float mul(float a, float b) const { return a * b; }
    float div(float a, float b) const { return a / b; }
    float sqrt(float a) const { return std::sqrt(a); }
    float mad(float a, float b, float c) const { return std::fma(a, b, c); }
    float round(double value) const { return static_cast<float>(value); }
};

/// Returns the expected result of an operation on a, b and c. Throws std::invalid_argument for powers.
template <class Oracle>
float oracle_result(Oracle& oracle, std::size_t operation, float a, float b, float c) {
    switch (operation) {
        case kAdd:
            return oracle.add(a, b);
        case kSub:
            return oracle.sub(a, b);
        case kMul:
            return oracle.mul(a, b);
        case kDiv:
            return oracle.div(a, b);
        case kSqrt:
            return oracle.sqrt(a);
        case kMad:
            return oracle.mad(a, b, c);
        case kMulAdd:
            return oracle.add(oracle.mul(a, b), c);
        case kMax:
            return a > b ? a : b;
        case kFloor:
            return std::floor(a);
        case kRound:
            return oracle.round(a);
        case kFromIndex:
            return oracle.round(std::bit_cast<std::uint32_t>(a));
        case kNeg:
            return -a;
        case kAbs:
            return std::abs(a);
        default:
            throw std::invalid_argument("the oracles do not compute powers");
    }
}

inline const std::vector<std::size_t> kRoundingOperations = {kAdd, kSub, kMul, kDiv, kSqrt, kMad, kMulAdd};

inline float flushed(float x) { return std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(0.0F, x) : x; }

/// The oracle of fp32 on a device that replaces denormal operands and results by zeros of the same sign.
template <class Oracle>
struct FlushingOracle {
    Oracle& exact;

    float add(float a, float b) { return flushed(exact.add(flushed(a), flushed(b))); }
    float sub(float a, float b) { return flushed(exact.sub(flushed(a), flushed(b))); }
    float mul(float a, float b) { return flushed(exact.mul(flushed(a), flushed(b))); }
    float div(float a, float b) { return flushed(exact.div(flushed(a), flushed(b))); }
    float sqrt(float a) { return flushed(exact.sqrt(flushed(a))); }
    float mad(float a, float b, float c) { return flushed(exact.mad(flushed(a), flushed(b), flushed(c))); }
    float round(double value) { return flushed(exact.round(value)); }
};

/// Returns the result of an operation in fp32 on a device that replaces denormal operands and results by zeros.
template <class Oracle>
float flushed_result(Oracle& oracle, std::size_t operation, float a, float b, float c) {
    FlushingOracle<Oracle> flushing{oracle};
    if (operation == kFromIndex) return oracle_result(flushing, operation, a, b, c);  // `a` is an integer
    return flushed(oracle_result(flushing, operation, flushed(a), flushed(b), flushed(c)));
}

/// Returns the expected results of `operations`, computed by the oracle for all rows.
template <class Oracle>
std::vector<ExpectedNumbers> expected_by(Oracle& oracle, const NumberRows& rows,
                                         const std::vector<std::size_t>& operations = kRoundingOperations) {
    std::vector<ExpectedNumbers> expected;
    for (const std::size_t operation : operations) {
        expected.push_back({.operation = operation});
        for (std::size_t i = 0; i < rows.count(); ++i) {
            const float a = rows.a[i], b = rows.b[i], c = rows.c[i];
            expected.back().results.push_back(std::bit_cast<std::uint32_t>(oracle_result(oracle, operation, a, b, c)));
            if constexpr (std::is_same_v<Oracle, const HostOracle> || std::is_same_v<Oracle, HostOracle>)
                expected.back().flushed.push_back(
                    std::bit_cast<std::uint32_t>(flushed_result(oracle, operation, a, b, c)));
        }
    }
    return expected;
}

/// Returns the expected results of `operations` in a reduced format, computed by MPFR for all rows.
inline std::vector<ExpectedNumbers> expected_by_mpfr(const NumberFormat& format, const NumberRows& rows,
                                                     const std::vector<std::size_t>& operations = kRoundingOperations) {
    MpfrOracle oracle(format);
    return expected_by(oracle, rows, operations);
}

}  // namespace raya
