// A driver that says it has copied, and has not: raya verify sees it in the check of the copies, and in images.
#include <algorithm>
#include <sstream>
#include <utility>

#include "tests/cli/failing_device.hpp"
#include "tests/cli/refusals.hpp"

namespace raya {
namespace {

/// Beginnings of the names of checks that ended so: lines that open with "FAIL  LAYER ".
Words checks_with(const Outcome& run, const std::string& beginning) {
    Words names;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(beginning)) names.push_back(line.substr(beginning.size()));
    return names;
}

long count_of(const Words& names, const std::string& part) {
    return std::count_if(names.begin(), names.end(), [&](const std::string& name) { return contains(name, part); });
}

Outcome verify_losing(const std::string& fault, const std::string& only) {
    return run_raya({"verify", "--only", only}, failing_device(fault));
}

TEST_CASE("copies that are lost are seen by the checks of what copies", "[cli][verify]") {
    struct Row {
        const char* fault;
        long rings, blocks, links;
    };
    for (const Row& row :
         {Row{"clEnqueueCopyBuffer 2 lost", 3, 0, 0}, Row{"clEnqueueCopyBufferRect 1 lost", 0, 1, 4}}) {
        const Outcome run = verify_losing(row.fault, "machine");
        INFO(run.told());
        CHECK(run.code == 4);
        const Words wrong = checks_with(run, "FAIL  machine   ");
        CHECK(count_of(wrong, "ring: rotations of") == row.rings);
        CHECK(count_of(wrong, "copies of blocks") == row.blocks);
        CHECK(count_of(wrong, "exchange of") == row.links);
        CHECK(row.rings + row.blocks + row.links == static_cast<long>(wrong.size()));
        CHECK(contains(run.out, "words are not where they should be"));
    }
}

TEST_CASE("copies that are lost are seen in the images of both machines", "[cli][verify]") {
    using Run = std::pair<const char*, const char*>;
    for (const auto& [only, fault] : {Run{"glass fp32 filter", "clEnqueueCopyBuffer 20 lost"},
                                      Run{"polygons fp32: torus3d 2x2x2", "clEnqueueCopyBufferRect 20 lost"}}) {
        const Outcome lost = verify_losing(fault, only);
        INFO(lost.told());
        CHECK(lost.code == 4);
        CHECK(checks_with(lost, "FAIL  image     ").size() == 1);
    }
}

TEST_CASE("a device that loses nothing is right: the tests above can pass", "[cli][verify]") {
    const Outcome run = verify_losing("clEnqueueCopyBuffer 1000000 lost", "exchange of");
    INFO(run.told());
    CHECK(run.code == 0);
}

}  // namespace
}  // namespace raya
