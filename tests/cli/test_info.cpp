// raya info: the figures equal those of renders, and the command needs no device.
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

/// Compares the figures of raya info for one machine and accelerator with the report of a render, which is null if the
/// render was refused with the message `error`.
void check_against_render(const Document& machine, const Document& need, const Document& report,
                          const std::string& error) {
    CAPTURE(machine.dump(), need.dump(), error);
    if (report.is_null()) {
        CHECK(need["fits"] == false);
        CHECK(need["missing_bytes"] ==
              need["pe_memory_used_bytes"].get<std::uint64_t>() - machine["pe_memory_bytes"].get<std::uint64_t>());
        const std::string refusal = need["refusal"];
        CHECK_THAT(error, Catch::Contains(refusal.substr(0, refusal.find("; use"))));
        return;
    }
    for (const char* key : {"pe_memory_bytes", "pes", "format"}) CHECK(report["machine"][key] == machine[key]);
    CHECK(report["machine"]["pe_memory_used_bytes"] == need["pe_memory_used_bytes"]);
    CHECK((need["missing_bytes"] == 0 && need["refusal"].is_null()));
    if (machine["name"] == "torus") return;
    CHECK(report["communication"]["broadcast_words"] == need["job_words"]);
    CHECK(need["job_bytes"] == 4 * need["job_words"].get<std::uint64_t>());
    if (report["accel"]["kind"] != "none") CHECK(report["accel"]["words"] == need["accel_words"]);
}

TEST_CASE("info: figures equal those of renders, for machines, accelerators and other options", "[cli]") {
    const ScratchFolder folder;
    const std::string random = folder / "random.nff", glass = scene_file("glass");
    REQUIRE(run_raya({"generate", "random", "2000", "-o", random}).code == 0);  // needs more than the 32 KB of a PE
    const std::vector<Arguments> rows = {{random, "--machine", "spa", "--format", "fp32"},
                                         {glass, "--machine", "torus", "--nodes", "2x2x1"},
                                         {glass, "--machine", "spa", "--pe-memory", "1000"},
                                         {glass, "--machine", "torus", "--pe-memory", "4000"},
                                         {random, "--machine", "grande"},
                                         {glass, "--machine", "spa", "--accel", "bvh"},
                                         {glass, "--machine", "spa", "--antialias", "filter", "--pes", "8"},
                                         {glass, "--machine", "cap", "--accel", "grid:3x2x1"},
                                         {glass, "--machine", "spa", "--format", "fp32"},
                                         {random, "--machine", "torus"},
                                         {random, "--machine", "grande", "--accel", "grid"}};
    for (const Arguments& row : quick_of(4, rows)) {
        Arguments info = {"info", "--json", "--size", "16", "--bounces", "4"},
                  render = {"render", "-o", folder / "x.pfm", "--report", folder / "x.json", "--lanes", "4",
                            "--size", "16", "--bounces",      "4"};
        for (Arguments* arguments : {&info, &render}) arguments->insert(arguments->end(), row.begin(), row.end());
        const RunOutcome printed = run_raya(
                             info, {.variables = {{"OCL_ICD_VENDORS", "/nowhere"}, {"OCL_ICD_FILENAMES", ""}}}),
                         rendered = run_raya(render);
        INFO(printed.describe() + rendered.describe());
        REQUIRE(printed.code == 0);
        CHECK((rendered.code == 0 || rendered.code == 2));
        const Document report = rendered.code == 0 ? json_of(folder / "x.json") : Document();
        const Document machines = Document::parse(printed.out)["machines"];
        REQUIRE(machines.size() == 1);
        std::size_t compared = 0;
        for (const Document& need : machines[0]["needs"]) {
            const std::string accel = need["accel"];
            const std::string kind =
                report.is_null() || accel == "voxels" ? accel : report["accel"]["kind"].get<std::string>();
            if (report.is_null() ? accel != "none" && accel != "voxels" : !accel.starts_with(kind)) continue;
            ++compared;
            check_against_render(machines[0], need, report, rendered.err);
            const bool is_given = std::find(row.begin(), row.end(), "--accel") != row.end();
            if (!report.is_null()) CHECK((need["default"] == true) == !is_given);
        }
        CHECK(compared == 1);
    }
}

}  // namespace
}  // namespace raya
