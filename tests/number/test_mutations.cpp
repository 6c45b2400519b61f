// The oracle test can fail: each of these faults, put into a copy of the layer, is seen on the operation that it
// spoils.
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/number/compare.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kSeed = 1993;
constexpr std::size_t kRows = 20'000;

struct Mutation {
    const char* what;
    SourcePatch patch;
    NumberFormat format;
    std::size_t operation;  // of operation_names(), the one that must go wrong
    bool refines = false;
};

const std::vector<Mutation>& mutations() {
    const NumberFormat spa = {6, 15, false}, wide = {8, 21, false};
    static const std::vector<Mutation> all = {
        {"residual of a sum dropped",
         {"number/reduced.clh", "num_fit(z, sum_error(a, b, z))", "num_fit(z, num_all(0.0f))"},
         spa,
         0},
        {"ties to odd",
         {"number/reduced.clh", "~(bits << (31 - RAYA_DROPPED))", "(bits << (31 - RAYA_DROPPED))"},
         spa,
         0},
        {"no saturation", {"number/reduced.clh", "min(as_lanes_uint(size), largest)", "as_lanes_uint(size)"}, spa, 2},
        {"flushes the smallest binade", {"number/reduced.clh", "((129 - (1 <<", "((130 - (1 <<"}, spa, 2},
        {"keeps a binade too many", {"number/reduced.clh", "((129 - (1 <<", "((128 - (1 <<"}, spa, 3},
        {"multiply, then add",
         {"number/reduced.clh", "const real z = fp32_fma(a, b, c);", "const real z = a * b + c;"},
         spa,
         5},
        {"residual of c dropped", {"number/reduced.clh", " + sum_error(c, -z, d)", ""}, spa, 5},
        {"residual of a root dropped",
         {"number/reduced.clh", "num_fit(z, fma(-z, z, x))", "num_fit(z, num_all(0.0f))"},
         spa,
         4},
        {"a product too small forgotten",
         {"number/scaled.clh", "choose(hint, sign * 0x1p-50f, scaled)", "scaled"},
         wide,
         5},
        {"a product above the range not scaled",
         {"number/scaled.clh", "fabs(a * b) > 0x1p120f", "fabs(a * b) > INFINITY"},
         wide,
         5},
        {"small products not scaled", {"number/scaled.clh", "fabs(a * b) < 0x1p-60f", "fabs(a * b) < 0.0f"}, wide, 2},
        {"one step of refinement", {"number/divide.clh", "i < 3", "i < 1"}, {8, 23, false}, 3, true},
        {"two steps of refinement", {"number/divide.clh", "i < 4", "i < 2"}, {8, 23, false}, 4, true},
    };
    return all;
}

// fp32 is no format of the oracle's: there the layer without the mutation is right, as test_fp32.cpp shows.
std::vector<std::uint32_t> right_results(const Mutation& mutation, const Operands& operands) {
    if (!mutation.format.is_fp32()) return expected_results(mutation.format, operands)[mutation.operation];
    const NumberBuild build = {mutation.format, widest_lanes(), mutation.refines};
    return NumberRunner(build).run("operations", operands, 6)[mutation.operation];
}

}  // namespace

TEST_CASE("faults put into the layer are seen", "[number][mutations]") {
    for (const Mutation& mutation : mutations()) {
        CAPTURE(mutation.what, mutation.patch.file, kSeed);
        const Operands operands = RandomOperands(mutation.format, kSeed).rows(kRows);
        const NumberBuild build = {mutation.format, widest_lanes(), mutation.refines, {mutation.patch}};
        const Results results = NumberRunner(build).run("operations", operands, 6);
        CHECK(differences(results[mutation.operation], right_results(mutation, operands)).count > 0);
    }
}

}  // namespace raya
