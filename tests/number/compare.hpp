// Results of the operations against the oracle, bit by bit.
#pragma once
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

#include "tests/number/mpfr_oracle.hpp"
#include "tests/number/number_runner.hpp"

namespace raya {

/// [operation][row]: the bits that the six operations must give.
inline Results expected_results(const NumberFormat& format, const Operands& operands) {
    MpfrOracle oracle(format);
    Results expected(operation_names().size());
    for (auto& column : expected) column.reserve(operands.rows());
    for (std::size_t i = 0; i < operands.rows(); ++i) {
        const float a = operands.a[i], b = operands.b[i], c = operands.c[i];
        const float values[] = {oracle.add(a, b), oracle.sub(a, b), oracle.mul(a, b),
                                oracle.div(a, b), oracle.sqrt(a),   oracle.mad(a, b, c)};
        for (std::size_t k = 0; k < expected.size(); ++k)
            expected[k].push_back(std::bit_cast<std::uint32_t>(values[k]));
    }
    return expected;
}

/// How many results of operation `k` differ, and the first row in which one does.
struct Differences {
    std::size_t count = 0, first = 0;
};

inline Differences differences(const std::vector<std::uint32_t>& found, const std::vector<std::uint32_t>& expected) {
    Differences all;
    for (std::size_t i = found.size(); i-- > 0;)
        if (found[i] != expected[i]) all = {all.count + 1, i};
    return all;
}

/// "3 of 1000 wrong, first mul(0x1p+0, 0x1p+1; 0x1p+3) = 0x1p+2, expected 0x1p+1", empty where all agree.
inline std::string report_differences(const std::string& operation, const Operands& operands,
                                      const std::vector<std::uint32_t>& found,
                                      const std::vector<std::uint32_t>& expected) {
    const Differences all = differences(found, expected);
    if (all.count == 0) return {};
    const std::size_t i = all.first;
    return fmt::format("{} of {} wrong, first in row {}: {}({:a}, {:a}; {:a}) = {:a}, expected {:a}", all.count,
                       found.size(), i, operation, operands.a[i], operands.b[i], operands.c[i],
                       std::bit_cast<float>(found[i]), std::bit_cast<float>(expected[i]));
}

/// The same for all operations, one line each.
inline std::string report_differences(const Operands& operands, const Results& found, const Results& expected) {
    std::string all;
    for (std::size_t k = 0; k < found.size(); ++k) {
        const std::string one = report_differences(operation_names()[k], operands, found[k], expected[k]);
        if (!one.empty()) all += one + '\n';
    }
    return all;
}

}  // namespace raya
