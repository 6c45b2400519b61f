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
        long rings, transfers, blocks;  // number of failed checks of each kind
    };
    for (const Row& row : {Row{"clEnqueueCopyBuffer 2 lost", 3, 0, 0}, Row{"clEnqueueCopyBuffer 40 astray", 1, 0, 0},
                           Row{"clEnqueueCopyBufferRect 1 lost", 3, 1, 1}}) {
        const RunOutcome run = verify_with_fault(row.fault, "machine");
        INFO(run.describe());
        CHECK(run.code == 4);
        const Arguments failed_checks = checks_with(run, "FAIL  machine   ");
        CHECK(count_containing(failed_checks, "ring: rotations of") == row.rings);
        CHECK(count_containing(failed_checks, "bus: transfers") == row.transfers);
        CHECK(count_containing(failed_checks, "copies of blocks") == row.blocks);
        CHECK(row.rings + row.transfers + row.blocks == static_cast<long>(failed_checks.size()));
        CHECK(contains(run.out, "words at wrong places"));
    }
}

TEST_CASE("verify: the image checks of the ring detect lost copies", "[cli][verify]") {
    const RunOutcome run = verify_with_fault("clEnqueueCopyBuffer 20 lost", "glass fp32 filter: cyclic:5");
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK(checks_with(run, "FAIL  image     ").size() == 1);
}

}  // namespace
}  // namespace raya
