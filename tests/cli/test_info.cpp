// raya info: the figures equal those of renders, and the command needs no device.
#include <fmt/core.h>

#include "host/base/whole_file.hpp"
#include "host/scene/nff.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

/// Options of a run without OpenCL drivers, so that any use of a device fails.
const RunOptions kNoDriver{.variables = {{"OCL_ICD_VENDORS", "/nowhere"}, {"OCL_ICD_FILENAMES", ""}}};

Document info_of(const std::string& scene, Arguments options = {}) {
    options.insert(options.begin(), {"info", scene, "--json"});
    const RunOutcome run = run_raya(options, kNoDriver);
    INFO(run.describe());
    REQUIRE(run.code == 0);
    return Document::parse(run.out);
}

const Document& machine_of(const Document& info, std::string_view name) {
    for (const Document& machine : info["machines"])
        if (machine["name"] == name) return machine;
    FAIL("no machine " << name);
    return info;
}

const Document& need_of(const Document& machine, std::string_view accel) {
    for (const Document& need : machine["needs"])
        if (need["accel"] == accel) return need;
    FAIL("no accelerator " << accel);
    return machine;
}

/// A render with the given options. `report` is set only if the render succeeds; `run` has its messages.
struct RenderedScene {
    RenderedScene(const ScratchFolder& folder, const std::string& scene, Arguments options) {
        options.insert(options.begin(), {"render", scene, "-o", folder / "x.pfm", "--report", folder / "x.json",
                                         "--lanes", "4", "--size", "16", "--bounces", "1"});
        run = run_raya(options);
        if (run.code == 0) report = Document::parse(file_contents(folder / "x.json"));
    }
    RunOutcome run;
    Document report;
};

/// Compares the figures of raya info for one machine and accelerator with those of a render.
void check_against_render(const Document& machine, const Document& need, const RenderedScene& rendered) {
    INFO(rendered.run.describe());
    CAPTURE(need.dump());
    if (need["fits"] == false) {
        CHECK(rendered.run.code == 2);
        CHECK(need["missing_bytes"] ==
              need["pe_memory_used_bytes"].get<std::uint64_t>() - machine["pe_memory_bytes"].get<std::uint64_t>());
        const std::string refusal = need["refusal"];
        CHECK_THAT(rendered.run.err, Catch::Contains(refusal.substr(0, refusal.find("; use"))));
        return;
    }
    REQUIRE(rendered.run.code == 0);
    const Document& machine_report = rendered.report["machine"];
    CHECK(machine_report["pe_memory_used_bytes"] == need["pe_memory_used_bytes"]);
    CHECK(machine_report["pe_memory_bytes"] == machine["pe_memory_bytes"]);
    CHECK(machine_report["pes"] == machine["pes"]);
    CHECK(machine_report["format"] == machine["format"]);
    CHECK(need["missing_bytes"] == 0);
    CHECK(need["refusal"].is_null());
    if (machine["name"] == "torus") return;
    CHECK(rendered.report["communication"]["broadcast_words"] == need["job_words"]);
    CHECK(need["job_bytes"] == 4 * need["job_words"].get<std::uint64_t>());
    const Document& accel = rendered.report["accel"];
    CHECK(accel["kind"] == need["accel"]);
    if (accel["kind"] != "none") CHECK(accel["words"] == need["accel_words"]);
}

TEST_CASE("info: figures equal those of renders, for every machine and accelerator", "[cli][slow]") {
    const ScratchFolder folder;
    const std::string random = folder / "random.nff";
    REQUIRE(run_raya({"generate", "random", "2000", "-o", random}).code == 0);  // needs more than the 32 KB of a PE
    for (const std::string& scene : {random, scene_file("centre")}) {
        CAPTURE(scene);
        const Document info = info_of(scene, {"--size", "16", "--bounces", "1"});
        REQUIRE(info["machines"].size() == 7);
        for (const char* name : {"spa", "grande"})
            for (const std::string& accel : quick<std::string>(scene == random ? 2 : 1, {"none", "bvh", "grid"})) {
                CAPTURE(name, accel);
                const Document& machine = machine_of(info, name);
                check_against_render(machine, need_of(machine, accel),
                                     RenderedScene(folder, scene, {"--machine", name, "--accel", accel}));
            }
        const Document& torus = machine_of(info, "torus");
        check_against_render(torus, need_of(torus, "voxels"), RenderedScene(folder, scene, {"--machine", "torus"}));
    }
    CHECK(need_of(machine_of(info_of(random), "spa"), "none")["fits"] == false);
}

TEST_CASE("info: takes the options of a render into account", "[cli][slow]") {
    const ScratchFolder folder;
    const std::string scene = scene_file("glass");
    for (const Arguments& options :
         {Arguments{"--machine", "spa", "--antialias", "filter", "--pes", "8"},
          Arguments{"--machine", "spa", "--format", "fp32"}, Arguments{"--machine", "cap", "--accel", "grid:3x2x1"},
          Arguments{"--machine", "spa", "--pe-memory", "1000"}, Arguments{"--machine", "torus", "--nodes", "2x2x1"},
          Arguments{"--machine", "torus", "--pe-memory", "4000"}}) {
        Arguments arguments = {"--size", "16", "--bounces", "1"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Document info = info_of(scene, arguments);
        REQUIRE(info["machines"].size() == 1);
        const Document& machine = info["machines"][0];
        const RenderedScene rendered(folder, scene, options);
        const std::string accel_kind = machine["name"] == "torus" ? "voxels"
                                       : rendered.run.code == 0   ? rendered.report["accel"]["kind"].get<std::string>()
                                                                  : "none";
        for (const Document& need : machine["needs"])
            if (need["accel"].get<std::string>().starts_with(accel_kind)) {
                if (accel_kind == "grid") {
                    CHECK(need["accel"] == "grid:3x2x1");
                    CHECK(rendered.report["machine"]["pe_memory_used_bytes"] == need["pe_memory_used_bytes"]);
                } else {
                    check_against_render(machine, need, rendered);
                }
            }
    }
}

TEST_CASE("info: names the accelerator that a render uses by default", "[cli]") {
    const ScratchFolder folder;
    for (const char* name : {"centre", "spheres"}) {
        const std::string scene = scene_file(name);
        const Document info = info_of(scene, {"--size", "16", "--bounces", "1"});
        for (const char* machine : {"spa", "grande"}) {
            CAPTURE(name, machine);
            const RenderedScene rendered(folder, scene, {"--machine", machine});
            REQUIRE(rendered.run.code == 0);
            int defaults = 0;
            for (const Document& need : machine_of(info, machine)["needs"]) {
                defaults += need["default"] == true;
                CHECK((need["default"] == true) == (need["accel"] == rendered.report["accel"]["kind"]));
            }
            CHECK(defaults == 1);
            for (const Document& fit : info["formats"])
                if (fit["format"] == rendered.report["machine"]["format"])
                    CHECK(fit["length_exponent"] == rendered.report["machine"]["length_exponent"]);
        }
        CHECK(info["view"] == RenderedScene(folder, scene, {}).report["view"]);
    }
}

TEST_CASE("info: counts the objects of the scene, and lists skipped lines", "[cli]") {
    const ScratchFolder folder;
    for (const char* name : {"polygons", "cones", "planes"}) {
        const Scene scene = read_nff(scene_file(name));
        const Document objects = info_of(scene_file(name))["objects"];
        CAPTURE(name);
        CHECK(objects["all"] == scene.object_count());
        CHECK(objects["spheres"] == scene.spheres.size());
        CHECK(objects["planes"] == scene.planes.size());
        CHECK(objects["polygons"] == scene.polygons.size());
        CHECK(objects["cones"] == scene.cones.size());
    }
    const std::string file = folder / "t.nff";
    write_whole_file(file,
                     "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 1\nresolution 8 8\nla 1 1 1\n"
                     "s 0 0 0 1\ns 9 9 9 1e-9\n");
    const RunOutcome run = run_raya({"info", file, "--format", "spa22", "--from", "0,-1e6,0"}, kNoDriver);
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.err, Catch::Contains("warning: " + file + ":8: entity 'la'"));
    CHECK_THAT(run.out, Catch::StartsWith(file + ": 2 objects: 2 spheres; 1 surface\n"));
    CHECK_THAT(run.out, Catch::Contains("camera  from 0,-1e+06,0 at 0,0,1") && Catch::Contains("8 x 8 pixels") &&
                            Catch::Contains("lights  none") && Catch::Contains("extent  -1..9 x -1..9 x -1..9") &&
                            Catch::Contains("skipped " + file + ":8: entity 'la'") &&
                            Catch::Contains("format  e6m15: ") && Catch::Contains("smaller than"));
    const Document info = info_of(file, {"--format", "spa22", "--from", "0,-1e6,0"});
    CHECK(info["skipped"][0]["line"] == 8);
    CHECK(info["warnings"].size() == 1);
    CHECK(info["formats"][0]["vanishing"] == 1);
    CHECK(info["extent"]["cube_half_side"] == 1e6);
}

TEST_CASE("info: shows that a scene does not fit a format, and the message of a render", "[cli]") {
    const ScratchFolder folder;
    const std::string file = folder / "far.nff";
    write_whole_file(file, "v\nfrom 0 -1e6 0\nat 0 0 0\nup 0 0 1\nangle 1\nhither 1\nresolution 64 64\ns 9 9 9 1e-5\n");
    const Document info = info_of(file);
    for (const Document& fit : info["formats"]) CHECK(fit["fits"] == (fit["format"] == "fp32"));
    const RunOutcome run = run_raya({"render", file, "-o", folder / "x.pfm"});
    CHECK(run.code == 2);
    const std::string refusal = need_of(machine_of(info, "spa"), "none")["refusal"];
    CHECK_THAT(run.err, Catch::Contains(refusal));
    CHECK(need_of(machine_of(info, "grande"), "none")["fits"] == true);
}

TEST_CASE("info: refuses invalid machines and options", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = scene_file("planes");
    check_refused(outputs, {"info", scene, "--format", "e9m9"}, 2, {"e9m9"});
    check_refused(outputs, {"info", scene, "--accel", "octree"}, 2, {"--accel octree"});
    check_refused(outputs, {"info", scene, "--machine", "spa", "--nodes", "2x2x2"}, 2,
                  {"--nodes 2x2x2 with --machine spa"});
    check_refused(outputs, {"info", scene, "--machine", "cap", "--offset", "3"}, 2, {"--offset 3"});
    check_refused(outputs, {"info", scene, "--machine", "cray"}, 2, {"--machine cray: no such machine"});
    check_refused(outputs, {"info", scene, "--from", "1,2"}, 2, {"--from 1,2"});
    check_refused(outputs, {"info", scene, "--device", "0"}, 2, {"no option --device"});
    check_refused(outputs, {"info", outputs / "no.nff"}, 2, {"no.nff: cannot read the scene"});
    const RunOutcome run = run_raya({"info", scene, "--offset", "3"}, kNoDriver);
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("cap: --offset 3"));  // only the row of cap has the error
}

}  // namespace
}  // namespace raya
