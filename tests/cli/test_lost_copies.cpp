// A driver that says it has copied, and has not, or to elsewhere: raya verify sees it in the check of the copies, and
// in images.
#include <algorithm>
#include <sstream>
#include <utility>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/failing_device.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

/// Beginnings of the names of checks that ended so: lines that open with "FAIL  LAYER ".
Words checks_with(const RunOutcome& run, const std::string& beginning) {
    Words names;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(beginning)) names.push_back(line.substr(beginning.size()));
    return names;
}

long count_of(const Words& names, const std::string& part) {
    return std::count_if(names.begin(), names.end(), [&](const std::string& name) { return contains(name, part); });
}

RunOutcome verify_losing(const std::string& fault, const std::string& only) {
    return run_raya({"verify", "--only", only}, failing_device(fault));
}

TEST_CASE("copies that are lost are seen by the checks of what copies", "[cli][verify]") {
    struct Row {
        const char* fault;
        long rings, transfers, blocks, links;
    };
    for (const Row& row :
         {Row{"clEnqueueCopyBuffer 2 lost", 3, 0, 0, 0}, Row{"clEnqueueCopyBuffer 40 astray", 1, 0, 0, 0},
          Row{"clEnqueueCopyBufferRect 1 lost", 3, 1, 1, 4}}) {
        const RunOutcome run = verify_losing(row.fault, "machine");
        INFO(run.told());
        CHECK(run.code == 4);
        const Words wrong = checks_with(run, "FAIL  machine   ");
        CHECK(count_of(wrong, "ring: rotations of") == row.rings);
        CHECK(count_of(wrong, "bus: transfers") == row.transfers);
        CHECK(count_of(wrong, "copies of blocks") == row.blocks);
        CHECK(count_of(wrong, "exchange of") == row.links);
        CHECK(row.rings + row.transfers + row.blocks + row.links == static_cast<long>(wrong.size()));
        CHECK(contains(run.out, "words are not where they should be"));
    }
}

TEST_CASE("copies that are lost are seen in the images of both machines", "[cli][verify]") {
    using Run = std::pair<const char*, const char*>;
    for (const auto& [only, fault] : {Run{"glass fp32 filter", "clEnqueueCopyBuffer 20 lost"},
                                      Run{"polygons fp32: torus3d 2x2x2", "clEnqueueCopyBufferRect 20 lost"}}) {
        const RunOutcome lost = verify_losing(fault, only);
        INFO(lost.told());
        CHECK(lost.code == 4);
        CHECK(checks_with(lost, "FAIL  image     ").size() == 1);
    }
}

TEST_CASE("a transfer over the bus that goes to the wrong PE is seen in the image", "[cli][verify]") {
    const ScratchFolder folder;
    const auto hash_of = [&](const std::string& way, const std::string& fault) {
        const RunOutcome run = run_raya(
            {"render", scene_file("planes"), "-o", folder / "i.pfm", "--report", folder / "r.json", "--size", "20x12",
             "--pes", "20", "--offset", "3", "--lanes", "4", "--antialias", "filter", "--exchange", way},
            failing_device(fault));
        INFO(run.told());
        REQUIRE(run.code == 0);
        return Document::parse(file_contents(folder / "r.json"))["image"]["hash"].get<std::string>();
    };
    const std::string whole = hash_of("ring", "clEnqueueCopyBufferRect 1000000 astray");
    for (const std::string way : {"bus", "bus-broadcast"}) {
        CAPTURE(way);
        CHECK(hash_of(way, "clEnqueueCopyBufferRect 1000000 astray") == whole);
        CHECK(hash_of(way, "clEnqueueCopyBufferRect 30 astray") != whole);
    }
}

TEST_CASE("a device that loses nothing is right: the tests above can pass", "[cli][verify]") {
    const RunOutcome run = verify_losing("clEnqueueCopyBuffer 1000000 lost", "exchange of");
    INFO(run.told());
    CHECK(run.code == 0);
}

}  // namespace
}  // namespace raya
