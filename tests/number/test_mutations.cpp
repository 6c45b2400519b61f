// Mutation tests of the number layer: each fault that is injected into a copy of the layer makes the comparison with
// the oracle fail for the operation that has the fault.
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/number/number_runs.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"
#include "tests/paths.h"

namespace raya {
namespace {

constexpr std::uint64_t kMutationSeed = 1993;
constexpr std::size_t kMutationRows = 20'000;

struct Mutation {
    const char* fault;
    SourcePatch patch;
    NumberFormat format;
    std::size_t operation;  // the operation whose results must be wrong
    bool refines = false;   // true: the build refines the results of a device with inexact division
};

const std::vector<Mutation>& mutations() {
    const NumberFormat spa = {6, 15, false}, wide = {8, 21, false};
    static const std::vector<Mutation> all = {
        {"residual of a sum dropped",
         {"number/reduced.clh", "num_fit(z, sum_error(a, b, z))", "num_fit(z, num_all(0.0f))"},
         spa,
         kAdd},
        {"ties to odd",
         {"number/reduced.clh", "~(bits << (31 - RAYA_DROPPED))", "(bits << (31 - RAYA_DROPPED))"},
         spa,
         kAdd},
        {"no saturation",
         {"number/reduced.clh", "min(as_lanes_uint(size), largest)", "as_lanes_uint(size)"},
         spa,
         kMul},
        {"flushes the smallest binade", {"number/reduced.clh", "((129 - (1 <<", "((130 - (1 <<"}, spa, kMul},
        {"does not flush the binade below the smallest number",
         {"number/reduced.clh", "((129 - (1 <<", "((128 - (1 <<"},
         spa,
         kDiv},
        {"multiply, then add",
         {"number/reduced.clh", "const real z = fp32_fma(a, b, c);", "const real z = a * b + c;"},
         spa,
         kMad},
        {"residual not computed where it decides",
         {"number/reduced.clh", "moved == (moved & ~RAYA_DROPPED_MASK)", "moved != moved"},
         spa,
         kMad},
        {"sign of a quotient without residual",
         {"number/reduced.clh", "num_fit_alone(z, as_lanes_int(a) ^ as_lanes_int(b))",
          "num_fit_alone(z, as_lanes_int(a))"},
         spa,
         kDiv},
        {"residual of c dropped", {"number/reduced.clh", " + sum_error(c, -z, d)", ""}, spa, kMad},
        {"residual of a square root dropped",
         {"number/reduced.clh", "num_fit(z, fma(-z, z, x))", "num_fit(z, num_all(0.0f))"},
         spa,
         kSqrt},
        {"tiny product ignored",
         {"number/scaled.clh", "choose(only_sign, sign * 0x1p-50f, scaled)", "scaled"},
         wide,
         kMad},
        {"a product above the range not scaled",
         {"number/scaled.clh", "fabs(a * b) > 0x1p120f", "fabs(a * b) > INFINITY"},
         wide,
         kMad},
        {"small products not scaled",
         {"number/scaled.clh", "fabs(a * b) < 0x1p-60f", "fabs(a * b) < 0.0f"},
         wide,
         kMul},
        {"only one step of refinement", {"number/divide.clh", "i < 3", "i < 1"}, {8, 23, false}, kDiv, true},
        {"only two steps of refinement", {"number/divide.clh", "i < 4", "i < 2"}, {8, 23, false}, kSqrt, true},
    };
    return all;
}

}  // namespace

TEST_CASE("faults injected into the number layer are detected", "[number][mutations]") {
    for (const Mutation& mutation : mutations()) {
        CAPTURE(mutation.fault, mutation.patch.file, kMutationSeed);
        const NumberRows rows = RandomOperands(mutation.format, kMutationSeed).rows(kMutationRows);
        NumberBuild build = mutation.refines ? refined_build(mutation.format) : number_build(mutation.format);
        build.sources.patches.push_back(mutation.patch);
        CHECK(wrong_numbers(build, rows, expected_by_mpfr(mutation.format, rows, {mutation.operation})) != "");
    }
}

}  // namespace raya
