// Tests of fault injection into kernels: with each fault exactly the checks that cover the faulty code fail.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/verify/verify.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

using Names = std::set<std::string>;

std::vector<Check> run(const std::vector<SourcePatch>& faults, const std::string& only) {
    return verify(choose_device(""), {.sources = {.patches = faults}, .only = only, .lanes = 4});
}

// Returns the names of the checks with this outcome.
Names names_of(const std::vector<Check>& checks, Outcome outcome) {
    Names names;
    for (const Check& check : checks)
        if (check.verdict.outcome == outcome) names.insert(check.name);
    return names;
}

// Returns a patch that makes the kernel return without doing anything.
SourcePatch empty_kernel_patch(const std::string& file, const std::string& kernel) {
    const std::string text = kernel_file(file);
    const std::size_t at = text.find("void " + kernel + "(");
    const std::string opening = text.substr(at, text.find("\n{", at) + 2 - at);
    return {file, opening, opening + " return;"};
}

}  // namespace

TEST_CASE("faults of kernels: exactly the checks that cover the faulty code fail", "[verify][faults]") {
    struct Row {
        SourcePatch fault;
        const char* only;
        Names wrong, right;          // names of the checks that must fail and pass
        const char *where, *result;  // parts of the texts of the first failure
    };
    const Row rows[] = {
        {kRoundingFault, "number", {"e5m10", "e6m15", "e8m12"}, {"fp32", "e6m15t", "e8m21t"}, "add(0x", "add"},
        {kContractionFault, "number fp32", {"fp32"}, {}, "mul_add(", "wrong: mul_add"},
        {kDivisionFault, "number fp32", {"fp32"}, {}, "div(", "wrong: div"},
        {kTieFault,
         "geometry*fp32",
         {"known_hits_of_spheres_fp32"},
         {"known_hits_of_planes_fp32", "known_hits_of_polygons_fp32", "known_hits_of_cones_fp32", "grid_fp32"},
         "equal distances",
         "rays wrong"},
        {kGridFault,
         "geometry*fp32",
         {"known_hits_of_spheres_fp32", "known_hits_of_planes_fp32", "known_hits_of_polygons_fp32",
          "known_hits_of_cones_fp32", "grid_fp32"},
         {},
         "hits_with_accel",
         "rays wrong"},
        {kMappingFault,
         "machine mapping",
         {"mapping_cyclic_block_fold", "mapping_blocks"},
         {"mapping_cyclic_cyclic_fold", "mapping_rows", "mapping_grid", "mapping_tiles", "mapping_random"},
         "pixel (row",
         "cases wrong"},
        {kBarrierFault,
         "machine local",
         {"local_memory_and_barriers_32_work_items"},
         {"local_memory_and_barriers_1_work_item"},
         "group 0",
         "cases wrong"},
        {kExchangeFault,
         "exchange of",
         {"torus3d_exchange_of_all_mailboxes", "torus3d_exchange_of_few_mailboxes", "torus2d_exchange_of_all_mailboxes",
          "torus2d_exchange_of_few_mailboxes"},
         {},
         "inbox",
         "words at wrong places"},
        {kBorderFault,
         "image glass",
         {"glass_fp32_filter_cyclic_5_on_10",
          "glass_fp32_filter_cyclic_8_on_7_block_fold_launches_of_1_test_pes_of_3300_bytes_groups_of_8"},
         {"glass_fp32_cyclic_8_on_20", "glass_fp32_cyclic_8_on_20_5_parts", "glass_fp32_axes_rows_on_16",
          "glass_fp32_diagonals_grid_4x4_on_16_launches_of_1_test", "glass_fp32_tiles_5x4_on_7",
          "glass_fp32_axes_rows_on_10_2_parts_pes_of_5000_bytes"},
         "row 0, column 19",
         "pixels wrong"},
        {kResumedLaunchFault,
         "image polygons fp32: torus3d 2x2x2",
         {"polygons_fp32_torus3d_2x2x2_launches_of_1_unit"},
         {"polygons_fp32_torus3d_2x2x2"},
         "",
         ""},
        {kLostPartFault,
         "image glass fp32: cyclic:8 on 20, 5 parts",
         {"glass_fp32_cyclic_8_on_20_5_parts"},
         {},
         "row",
         "wrong"},
        {kPartTwiceFault,
         "image glass fp32: cyclic:8 on 20, 5 parts",
         {"glass_fp32_cyclic_8_on_20_5_parts"},
         {},
         "",
         "sphere_tests"},
        {kRotationFault,
         "image glass fp32: cyclic:8 on 20, 5 parts",
         {"glass_fp32_cyclic_8_on_20_5_parts"},
         {},
         "row",
         "wrong"},
        {kSeparateFault, "image leaves", {"leaves_fp32_cyclic_8_on_20_bvh_4x1"}, {}, "row", "pixels wrong"},
        {kRoundingFault, "image cones e5m10", {"cones_e5m10_cyclic_8_on_20_fallback_code"}, {}, "row", "pixels wrong"},
        // With parts of one object, object numbers alone decide ties.
        {kTieFault,
         "image ties",
         {"ties_fp32_blocks_on_5_global_words_fallback_code"},
         {"ties_fp32_cyclic_8_on_20_20_parts_pes_of_2000_bytes"},
         "row",
         "pixels wrong"}};
    for (const Row& row : rows) {
        CAPTURE(row.fault.replace, row.only);
        const auto checks = run({row.fault}, row.only);
        CHECK(names_of(checks, Outcome::kFail) == row.wrong);
        CHECK(names_of(checks, Outcome::kPass) == row.right);
        const auto first = std::ranges::find(checks, Outcome::kFail, [](const Check& c) { return c.verdict.outcome; });
        REQUIRE(first != checks.end());
        CHECK_THAT(first->verdict.fault.where, Catch::Contains(row.where));
        CHECK_THAT(first->verdict.result, Catch::Contains(row.result));
        if (row.where[0] == '\0') continue;  // the torus lost packets, an internal error
        CHECK(first->verdict.fault.expected != first->verdict.fault.got);
    }
}

TEST_CASE("a kernel that does nothing: its checks fail", "[verify][faults]") {
    struct Row {
        const char *file, *kernel, *only;
        std::size_t wrong;  // number of checks that must fail
    };
    const Row rows[] = {{"checks/hits.cl", "hits_without_accel", "geometry*fp32", 5},
                        {"checks/hits.cl", "hits_with_accel", "geometry*fp32", 5},
                        {"checks/machine.cl", "find_owners", "mapping", 7},
                        {"checks/machine.cl", "find_routes", "routes", 1},
                        {"torus/exchange.cl", "exchange", "exchange of", 4},
                        {"checks/machine.cl", "reverse_words", "local memory", 2},
                        {"checks/numbers.cl", "operations", "number fp32", 1}};
    for (const Row& row : rows) {
        CAPTURE(row.kernel);
        const auto checks = run({empty_kernel_patch(row.file, row.kernel)}, row.only);
        CHECK(names_of(checks, Outcome::kFail).size() == row.wrong);
        CHECK(checks.size() == row.wrong);
    }
}

TEST_CASE("count faults at one place: the check of an image with this event fails", "[verify][faults][slow]") {
    for (const CountFault& fault : kCountFaults) {
        CAPTURE(fault.event, fault.patch.file, fault.patch.replace);
        const auto checks = run({fault.patch}, fault.only);
        REQUIRE(checks.size() == 1);
        REQUIRE(names_of(checks, Outcome::kFail).size() == 1);
        const Verdict& verdict = checks[0].verdict;
        CHECK_THAT(verdict.result, Catch::StartsWith("wrong counts: "));
        CHECK_THAT(verdict.result + ",", Catch::Contains(fmt::format(" {},", fault.event)));
        CHECK_THAT(verdict.fault.expected, Catch::Contains(fmt::format("{} ", fault.event)));
        CHECK_THAT(verdict.fault.got, Catch::Contains(fmt::format("{} ", fault.event)));
        CHECK(verdict.fault.expected != verdict.fault.got);
    }
}

TEST_CASE("verify: a failed build fails its check, and the other checks run", "[verify]") {
    const VerifySettings settings{.sources = {"/no/such/folder"}, .only = "machine"};
    const auto checks = verify(choose_device(""), settings);
    CHECK(count_of(checks, Outcome::kFail) > 5);
    CHECK(count_of(checks, Outcome::kPass) > 5);  // checks of transfers use no kernel
}

TEST_CASE("verify: refuses a patch that does not apply, before any check", "[verify]") {
    CHECK_THROWS_AS(run({{"ring/trace.cl", "no such text", ""}}, "machine"), std::logic_error);
}

}  // namespace raya
