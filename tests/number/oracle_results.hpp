// Expected results of operations, computed by MPFR.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "host/verify/numbers.hpp"
#include "tests/number/mpfr_oracle.hpp"

namespace raya {

/// Returns the expected result of an operation on a, b and c. Throws std::invalid_argument for powers.
inline float oracle_result(MpfrOracle& oracle, std::size_t operation, float a, float b, float c) {
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
            return oracle.flush(a) > oracle.flush(b) ? oracle.flush(a) : oracle.flush(b);
        case kFloor:
            return std::floor(oracle.flush(a));
        case kRound:
            return oracle.round(oracle.flush(a));
        case kFromIndex:
            return oracle.round(std::bit_cast<std::uint32_t>(a));
        case kNeg:
            return -oracle.flush(a);
        case kAbs:
            return std::abs(oracle.flush(a));
        default:
            throw std::invalid_argument("the oracle does not compute powers");
    }
}

inline const std::vector<std::size_t> kRoundingOperations = {kAdd, kSub, kMul, kDiv, kSqrt, kMad, kMulAdd};

/// Returns the expected results of `operations`, computed by MPFR for all rows.
inline std::vector<ExpectedNumbers> expected_by_mpfr(const NumberFormat& format, const NumberRows& rows,
                                                     const std::vector<std::size_t>& operations = kRoundingOperations) {
    MpfrOracle oracle(format), flushing(format, true);
    std::vector<ExpectedNumbers> expected;
    for (const std::size_t operation : operations) {
        expected.push_back({.operation = operation});
        const auto bits = [&](MpfrOracle& by, std::size_t i) {
            return std::bit_cast<std::uint32_t>(oracle_result(by, operation, rows.a[i], rows.b[i], rows.c[i]));
        };
        for (std::size_t i = 0; i < rows.count(); ++i) {
            expected.back().results.push_back(bits(oracle, i));
            if (format.is_fp32()) expected.back().flushed.push_back(bits(flushing, i));
        }
    }
    return expected;
}

}  // namespace raya
