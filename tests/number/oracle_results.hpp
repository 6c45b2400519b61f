// Computes expected results of operations with an oracle, such as MpfrOracle or HostOracle.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
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

/// Returns the expected results of `operations`, computed by the oracle for all rows.
template <class Oracle>
std::vector<ExpectedNumbers> expected_by(Oracle& oracle, const NumberRows& rows,
                                         const std::vector<std::size_t>& operations = kRoundingOperations) {
    std::vector<ExpectedNumbers> expected;
    for (const std::size_t operation : operations) {
        expected.push_back({.operation = operation});
        for (std::size_t i = 0; i < rows.count(); ++i)
            expected.back().results.push_back(
                std::bit_cast<std::uint32_t>(oracle_result(oracle, operation, rows.a[i], rows.b[i], rows.c[i])));
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
