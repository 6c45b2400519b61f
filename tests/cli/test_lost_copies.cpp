// The checks of copies and of images in raya verify detect a driver that loses or misdirects copies.
#include <algorithm>
#include <sstream>
#include <utility>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

/// Returns the names of the checks whose lines begin with `beginning`, such as "FAIL  LAYER ".
Arguments checks_with(const RunOutcome& run, const std::string& beginning) {
    Arguments names;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(beginning)) names.push_back(line.substr(beginning.size()));
    return names;
}

long count_containing(const Arguments& names, const std::string& part) {
    return std::count_if(names.begin(), names.end(), [&](const std::string& name) { return contains(name, part); });
}

RunOutcome verify_with_fault(const std::string& fault, const std::string& check_name) {
    return run_raya({"verify", "--only", check_name}, device_with_fault(fault));
}

TEST_CASE("verify: the checks of copies detect lost copies", "[cli][verify]") {
    struct Row {
        const char* fault;
        long rings, transfers, blocks, links;  // number of failed checks of each kind
    };
    for (const Row& row :
         {Row{"clEnqueueCopyBuffer 2 lost", 3, 0, 0, 0}, Row{"clEnqueueCopyBuffer 40 astray", 1, 0, 0, 0},
          Row{"clEnqueueCopyBufferRect 1 lost", 3, 1, 1, 4}}) {
        const RunOutcome run = verify_with_fault(row.fault, "machine");
        INFO(run.describe());
        CHECK(run.code == 4);
        const Arguments failed_checks = checks_with(run, "FAIL  machine   ");
        CHECK(count_containing(failed_checks, "ring: rotations of") == row.rings);
        CHECK(count_containing(failed_checks, "bus: transfers") == row.transfers);
        CHECK(count_containing(failed_checks, "copies of blocks") == row.blocks);
        CHECK(count_containing(failed_checks, "exchange of") == row.links);
        CHECK(row.rings + row.transfers + row.blocks + row.links == static_cast<long>(failed_checks.size()));
        CHECK(contains(run.out, "words at wrong places"));
    }
}

TEST_CASE("verify: the image checks of both machines detect lost copies", "[cli][verify]") {
    using Run = std::pair<const char*, const char*>;
    for (const auto& [check_name, fault] :
         {Run{"glass fp32 filter: cyclic:5", "clEnqueueCopyBuffer 20 lost"},
          Run{"far fp32: torus3d 3x2x2, history", "clEnqueueCopyBufferRect 20 lost"}}) {
        const RunOutcome run = verify_with_fault(fault, check_name);
        INFO(run.describe());
        CHECK(run.code == 4);
        CHECK(checks_with(run, "FAIL  image     ").size() == 1);
    }
}

TEST_CASE("render: a bus transfer to the wrong PE changes the image", "[cli][verify]") {
    const ScratchFolder folder;
    const auto hash_of = [&](const std::string& exchange, const std::string& fault) {
        const RunOutcome run = run_raya(
            {"render", scene_file("planes"), "-o", folder / "i.pfm", "--report", folder / "r.json", "--size", "20x12",
             "--pes", "20", "--offset", "3", "--lanes", "4", "--antialias", "filter", "--exchange", exchange},
            device_with_fault(fault));
        INFO(run.describe());
        REQUIRE(run.code == 0);
        return Document::parse(file_contents(folder / "r.json"))["image"]["hash"].get<std::string>();
    };
    const std::string expected = hash_of("ring", "clEnqueueCopyBufferRect 1000000 astray");
    for (const std::string exchange : {"bus", "bus-broadcast"}) {
        CAPTURE(exchange);
        CHECK(hash_of(exchange, "clEnqueueCopyBufferRect 1000000 astray") == expected);
        CHECK(hash_of(exchange, "clEnqueueCopyBufferRect 30 astray") != expected);
    }
}

TEST_CASE("verify: passes with a fault that is never reached (control)", "[cli][verify]") {
    const RunOutcome run = verify_with_fault("clEnqueueCopyBuffer 1000000 lost", "exchange of");
    INFO(run.describe());
    CHECK(run.code == 0);
}

}  // namespace
}  // namespace raya
