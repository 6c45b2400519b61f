// Tests of fault injection into kernels: with each fault exactly the checks that cover the faulty code fail.
#include <catch2/catch.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/verify/reference_images.hpp"
#include "host/verify/verify.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

using Names = std::set<std::string>;

std::vector<Check> run(const std::vector<SourcePatch>& faults, const std::string& only) {
    return verify(choose_device(""), {.sources = {.patches = faults}, .only = only});
}

// Returns the names of the failed checks.
Names failures(const std::vector<Check>& checks) {
    Names names;
    for (const Check& check : checks)
        if (check.verdict.outcome == Outcome::kFail) names.insert(check.name);
    return names;
}

// Returns the names of the checks with this outcome, each up to its first comma.
Names beginnings(const std::vector<Check>& checks, Outcome outcome) {
    Names names;
    for (const Check& check : checks)
        if (check.verdict.outcome == outcome) names.insert(check.name.substr(0, check.name.find(',')));
    return names;
}

const Fault& first_fault(const std::vector<Check>& checks) {
    for (const Check& check : checks)
        if (check.verdict.outcome == Outcome::kFail) return check.verdict.fault;
    throw std::logic_error("nothing failed");
}

// Returns a patch that makes the kernel return without doing anything.
SourcePatch empty_kernel_patch(const std::string& file, const std::string& kernel) {
    const std::string text = kernel_file(file);
    const std::size_t at = text.find("void " + kernel + "(");
    const std::string opening = text.substr(at, text.find("\n{", at) + 2 - at);
    return {file, opening, opening + " return;"};
}

}  // namespace

TEST_CASE("rounding fault: only the checks of reduced formats that round to nearest fail", "[verify][faults]") {
    const auto checks = run({kRoundingFault}, "number");
    CHECK(beginnings(checks, Outcome::kFail) == Names{"e5m10", "e6m15", "e8m12"});
    CHECK(beginnings(checks, Outcome::kPass) == Names{"fp32", "e6m15t", "e8m21t"});
    const Fault& fault = first_fault(checks);
    CHECK_THAT(fault.where, Catch::StartsWith("add(0x") && Catch::EndsWith("in e5m10"));
    CHECK_THAT(fault.expected, Catch::StartsWith("0x"));
    CHECK_THAT(fault.got, Catch::StartsWith("0x"));
    CHECK(fault.expected != fault.got);
    CHECK_THAT(fault.options, Catch::Contains("-DRAYA_FRACTION_BITS=10"));
    CHECK_FALSE(fault.remedies.empty());
}

TEST_CASE("contraction fault: the operation mul_add fails, not mad", "[verify][faults]") {
    const auto checks = run({kContractionFault}, "number fp32");
    REQUIRE(checks.size() == 1);
    CHECK_THAT(checks[0].verdict.result, Catch::Contains("mul_add") && !Catch::Contains(" of mad"));
    CHECK_THAT(checks[0].verdict.fault.where, Catch::StartsWith("mul_add("));
}

TEST_CASE("division fault: div fails, not mul", "[verify][faults]") {
    const auto checks = run({kDivisionFault}, "number fp32");
    REQUIRE(failures(checks).size() == 1);
    CHECK_THAT(checks[0].verdict.result, Catch::Contains("div ") && !Catch::Contains("mul "));
}

TEST_CASE("tie fault: only the check of known hits of spheres fails, at equal distances", "[verify][faults]") {
    const auto checks = run({kTieFault}, ", fp32");
    CHECK(beginnings(checks, Outcome::kFail) == Names{"known hits of spheres"});
    CHECK(beginnings(checks, Outcome::kPass) ==
          Names{"known hits of planes", "known hits of polygons", "known hits of cones", "grid"});
    CHECK_THAT(first_fault(checks).where, Catch::Contains("equal distances"));
    CHECK_THAT(first_fault(checks).expected, Catch::StartsWith("object 2"));
    CHECK_THAT(first_fault(checks).got, Catch::StartsWith("object 3"));
}

TEST_CASE("grid fault: all checks of hits with the grid fail", "[verify][faults]") {
    const auto checks = run({kGridFault}, ", fp32");
    CHECK(failures(checks).size() == 5);
    CHECK_THAT(first_fault(checks).where, Catch::Contains("hits_with_accel"));
}

TEST_CASE("faults of arithmetic, hits and grid: image checks fail too", "[verify][faults]") {
    struct Row {
        SourcePatch fault;
        const char* only;
        Names wrong;  // names of the checks that must fail
    };
    const Row rows[] = {
        {kRoundingFault, "image cones e5m10", {"cones e5m10: cyclic:8 on 20, fallback code"}},
        {kContractionFault, "image glass fp32: cyclic:8 on 20", {"glass fp32: cyclic:8 on 20"}},
        {kDivisionFault,
         "image ties fp32: blocks on 5, global words, fallback code",
         {}},  // the build options exclude the patched code
        {kDivisionFault, "image glass fp32: tiles:5x4 on 7", {"glass fp32: tiles:5x4 on 7"}},
        {kTieFault, "image ties", {"ties fp32: blocks on 5, global words, fallback code"}},
        {kGridFault, "image polygons fp32: cyclic:8 on 20, grid", {"polygons fp32: cyclic:8 on 20, grid"}},
        {kGridFault, "image polygons fp32: torus3d 2x2x2, ", {"polygons fp32: torus3d 2x2x2, launches of 1 unit"}}};
    for (const Row& row : rows) {
        CAPTURE(row.fault.replace, row.only);
        const auto checks = run({row.fault}, row.only);
        CHECK(checks.size() == 1);
        CHECK(failures(checks) == row.wrong);
    }
}

TEST_CASE("a kernel that does nothing: its checks fail", "[verify][faults]") {
    struct Row {
        const char *file, *kernel, *only;
        std::size_t wrong;  // number of checks that must fail
    };
    const Row rows[] = {{"checks/hits.cl", "hits_without_accel", ", fp32", 5},
                        {"checks/hits.cl", "hits_with_accel", ", fp32", 5},
                        {"checks/machine.cl", "find_owners", "mapping", 7},
                        {"checks/machine.cl", "find_routes", "routes", 1},
                        {"checks/machine.cl", "reverse_words", "local memory", 2},
                        {"checks/numbers.cl", "operations", "number fp32", 1}};
    for (const Row& row : rows) {
        CAPTURE(row.kernel);
        const auto checks = run({empty_kernel_patch(row.file, row.kernel)}, row.only);
        CHECK(failures(checks).size() == row.wrong);
        CHECK(checks.size() == row.wrong);
    }
}

TEST_CASE("integer and barrier faults: only the machine checks that cover them fail", "[verify][faults]") {
    CHECK(failures(run({}, "machine")) == Names{});
    CHECK(failures(run({kMappingFault}, "machine")) == Names{"mapping: cyclic, block fold", "mapping: blocks"});
    CHECK(failures(run({kBarrierFault}, "machine")) == Names{"local memory and barriers, 32 work-items"});
}

TEST_CASE("border fault: only images with the filter fail, and the check names the pixel", "[verify][faults]") {
    const auto checks = run({kBorderFault}, "image glass");
    CHECK(failures(checks) ==
          Names{"glass fp32 filter: cyclic:5 on 10",
                "glass fp32 filter: cyclic:8 on 7, block fold, launches of 1 test, PEs of 3300 bytes, groups of 8"});
    CHECK(checks.size() > 4);
    CHECK_THAT(first_fault(checks).where, Catch::StartsWith("row 0, column 19"));
}

TEST_CASE("faults of link exchange by kernel and of resumed launches: only the torus checks that cover them fail",
          "[verify][faults]") {
    const Names by_kernel = {"torus3d: exchange of all mailboxes", "torus3d: exchange of few mailboxes",
                             "torus2d: exchange of all mailboxes", "torus2d: exchange of few mailboxes"};
    CHECK(failures(run({kExchangeFault}, "exchange of")) == by_kernel);
    CHECK(failures(run({empty_kernel_patch("torus/exchange.cl", "exchange")}, "exchange of")) == by_kernel);
    const Names limited_launches = {"polygons fp32: torus3d 2x2x2, launches of 1 unit"};
    const auto checks = run({kResumedLaunchFault}, "image polygons fp32: torus3d 2x2x2");
    CHECK(checks.size() == 2);
    CHECK(failures(checks) == limited_launches);
}

TEST_CASE("count faults at one place: the check of an image with this event fails", "[verify][faults][slow]") {
    for (const CountFault& fault : kCountFaults) {
        CAPTURE(fault.event, fault.patch.file, fault.patch.replace);
        const auto checks = run({fault.patch}, fault.only);
        REQUIRE(checks.size() == 1);
        REQUIRE(failures(checks).size() == 1);
        const Verdict& verdict = checks[0].verdict;
        CHECK_THAT(verdict.result, Catch::StartsWith("wrong counts: "));
        CHECK_THAT(verdict.result + ",", Catch::Contains(fmt::format(" {},", fault.event)));
        CHECK_THAT(verdict.fault.expected, Catch::Contains(fmt::format("{} ", fault.event)));
        CHECK_THAT(verdict.fault.got, Catch::Contains(fmt::format("{} ", fault.event)));
        CHECK(verdict.fault.expected != verdict.fault.got);
    }
}

TEST_CASE("count faults of every event: an image check fails", "[verify][faults][.][long]") {
    for (int event = 0; event < RAYA_EVENTS; ++event)
        for (const int how : {0, 1, 2}) {
            const bool traversal = event == RAYA_WALKS || event == RAYA_STEPS, torus_only = event == RAYA_DISCARDED;
            CAPTURE(event, how);
            if (!torus_only)
                CHECK(failures(run({ring_count_fault(event, how)}, traversal                  ? kOnBvh
                                                                   : event == RAYA_CONE_TESTS ? kOnCones
                                                                                              : kOnGlass))
                          .size() == 1);
            const bool on_torus = event != RAYA_SPHERE_TESTS && event != RAYA_PLANE_TESTS && event != RAYA_CONE_TESTS &&
                                  event != RAYA_REFRACTED;  // the torus image has only polygons
            if (on_torus) CHECK(failures(run({torus_count_fault(event, how)}, kOnTorus)).size() == 1);
        }
}

TEST_CASE("count faults: only image checks fail", "[verify][faults][slow]") {
    const auto checks = run({kCountFaults.front().patch, torus_count_fault(RAYA_SHADOW, 2)}, "");
    std::set<std::string> layers;
    for (const Check& check : checks)
        if (check.verdict.outcome == Outcome::kFail) layers.insert(check.layer);
    CHECK(layers == std::set<std::string>{"image"});
    CHECK(failures(checks).size() >= 8);
}

TEST_CASE("reference images: have the counts of the ring and of other check kinds", "[verify]") {
    for (const ReferenceImage& image : reference_images()) CHECK(stored_image(image).counts.contains("ring"));
    CHECK_THAT(stored_image(reference_image_named("polygons fp32")).counts.at("bvh"),
               Catch::StartsWith("primary 400 "));
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
