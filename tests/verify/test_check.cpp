// Tests of struct Check and of the selection of checks: exceptions, remedies, depths, and conversion to JSON and back.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <stdexcept>

#include "host/error.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

// Returns the remedies of a check that throws an exception of type `Error` with this message, one line for each.
template <class Error>
std::string remedies_after(const std::string& message, const VerifySettings& settings = {}) {
    const Check check = run_check("layer", "name", [&]() -> Verdict { throw Error(message); });
    CHECK(check.verdict.outcome == Outcome::kFail);
    std::string text;
    for (const std::string& remedy : remedies_of(check, settings)) text += remedy + '\n';
    return text;
}

}  // namespace

TEST_CASE("run_check: a check that throws an exception fails, with remedies for the reason", "[verify]") {
    using Catch::Contains;
    CHECK_THAT(remedies_after<DeviceError>("building program 'x.cl': clBuildProgram failed with "
                                           "CL_BUILD_PROGRAM_FAILURE (-11)\n  options: -w"),
               Contains("build log") && Contains("-cl-opt-disable") && Contains("--lanes 1"));
    CHECK_THAT(remedies_after<DeviceError>("allocating buffer 'x' (8 bytes): CL_MEM_OBJECT_ALLOCATION_FAILURE (-4)"),
               Contains("out of memory") && !Contains("build log"));
    CHECK_THAT(remedies_after<DeviceError>("'x': clFinish failed with CL_DEVICE_NOT_AVAILABLE (-2)"),
               Contains("the device was lost") && !Contains("memory"));
    CHECK_THAT(remedies_after<std::logic_error>("400 packets of kind 1 were made, 399 ended"), Contains("report it"));
    ::setenv("RAYA_BUILD_OPTIONS", "-cl-opt-disable", 1);
    const std::string remedies = remedies_after<DeviceError>("another reason", {.lanes = 1});
    ::unsetenv("RAYA_BUILD_OPTIONS");
    CHECK_THAT(remedies, Contains("raya devices") && !Contains("-cl-opt-disable") && !Contains("--lanes"));
}

TEST_CASE("check_ids: a greater depth has all checks of the smaller depths, and more", "[verify]") {
    const auto ids = [](Depth depth) { return check_ids(choose_device(""), {.depth = depth, .lanes = 1}); };
    const std::vector<std::string> brief = ids(Depth::kBrief), quick = ids(Depth::kQuick), full = ids(Depth::kFull);
    const auto has = [](const std::vector<std::string>& all, const std::vector<std::string>& subset) {
        return std::all_of(subset.begin(), subset.end(),
                           [&](const std::string& id) { return std::find(all.begin(), all.end(), id) != all.end(); });
    };
    CHECK((has(quick, brief) && brief.size() < quick.size()));
    CHECK((has(full, quick) && quick.size() < full.size()));
    for (const char* layer : {"number.", "geometry.", "machine.", "image."}) {
        CAPTURE(layer);
        CHECK(std::any_of(brief.begin(), brief.end(), [&](const std::string& id) { return id.starts_with(layer); }));
    }
}

TEST_CASE("from_json<Check>: inverts to_json", "[verify]") {
    const Fault fault{.where = "there", .expected = "1", .got = "2", .options = "-w", .remedies = {"this", "that"}};
    for (const Verdict& verdict : {passed("3 answers"), skipped("no reason"), failed("wrong", fault)}) {
        const Check check{"layer", "name", 1.5, verdict};
        CHECK(to_json(from_json<Check>(to_json(check))).dump() == to_json(check).dump());
        CHECK(check_lines(from_json<Check>(to_json(check))) == check_lines(check));
    }
}

}  // namespace raya
