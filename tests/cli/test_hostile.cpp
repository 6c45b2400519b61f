// Inputs and drivers of somebody who wishes ill, or has bad luck: no input is overwritten, nothing waits for ever, and
// what is wrong is named.
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <string>

#include "host/verify/verify.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string copied_scene(const ScratchFolder& folder) {
    fs::copy_file(scene_file("centre"), folder / "s.nff");
    return (folder / "s.nff").string();
}

// Checks that the command is refused with these texts, and changes no file of `inputs`.
void check_unchanged(const ScratchFolder& inputs, const Arguments& arguments, const Arguments& message) {
    std::map<std::string, std::string> before;
    for (const auto& entry : fs::directory_iterator(inputs.path()))
        if (entry.is_regular_file()) before[entry.path().string()] = file_contents(entry.path());
    const RunOutcome run = run_raya(arguments);
    INFO(run.describe());
    CHECK(run.code == 2);
    for (const std::string& part : message) CHECK_THAT(run.err, Catch::Contains(part));
    for (const auto& [file, bytes] : before) CHECK((file_contents(file) == bytes));
}

constexpr const char *kTriangle = "usemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", *kMaterial = "newmtl a\nKd 1 0 0\n";

TEST_CASE("no output overwrites a file that --as, a mesh or a list of failures names", "[cli][hostile]") {
    const ScratchFolder inputs, outputs;
    const std::string scene = copied_scene(inputs);
    for (const char* option : {"--report", "--junit"})
        check_unchanged(inputs, {"verify", "--as", "render " + scene + " --size 16", "--only", "number", option, scene},
                        {option, "would overwrite the input"});
    write_text(inputs / "x.obj", std::string("mtllib m.mtl\n") + kTriangle);
    write_text(inputs / "m.mtl", kMaterial);
    const std::string image = outputs / "x.pfm";
    check_unchanged(inputs, {"render", inputs / "x.obj", "-o", image, "--size", "8", "--report", inputs / "m.mtl"},
                    {"--report", "would overwrite the input", "m.mtl"});
    fs::create_hard_link(inputs / "m.mtl", inputs / "other.json");
    check_unchanged(inputs, {"render", inputs / "x.obj", "-o", image, "--size", "8", "--report", inputs / "other.json"},
                    {"--report", "would overwrite the input"});
    const std::string points(36, '\0');
    write_text(inputs / "b.bin", points);
    write_text(inputs / "x.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": "b.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})");
    check_unchanged(inputs, {"render", inputs / "x.gltf", "-o", image, "--size", "8", "--report", inputs / "b.bin"},
                    {"--report", "would overwrite the input", "b.bin"});
    check_unchanged(inputs, {"verify", "--as", "render " + (inputs / "x.obj").string(), "--report", inputs / "m.mtl"},
                    {"--report", "would overwrite the input", "m.mtl"});
    CHECK(outputs.entries() == 0);
}

TEST_CASE("meshes: files outside the mesh's folder are refused, pipes are not opened", "[cli][hostile]") {
    const ScratchFolder folder, outputs;
    fs::create_directory(folder / "mesh");
    write_text(folder / "m.mtl", kMaterial);
    fs::create_symlink(folder / "m.mtl", folder / "mesh/link.mtl");
    REQUIRE(::mkfifo((folder / "mesh/pipe.mtl").c_str(), 0600) == 0);
    const auto render = [&](const std::string& library) {
        write_text(folder / "mesh/x.obj", "mtllib " + library + "\n" + kTriangle);
        return Arguments{"render", folder / "mesh/x.obj", "-o", outputs / "x.pfm", "--size", "8", "--pes", "8",
                         "--quiet"};
    };
    for (const char* outside : {"../m.mtl", "link.mtl"})
        check_refused(outputs, render(outside), 2, {outside, "is not in the mesh's folder"});
    const auto start = std::chrono::steady_clock::now();
    const RunOutcome run = run_raya(render("pipe.mtl"));
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.err, Catch::Contains("pipe.mtl"));
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(60));  // RAYA_MESH_TIMEOUT is 120 s
}

TEST_CASE("meshes: a face of 96,000 corners is refused at once", "[cli][hostile]") {
    const ScratchFolder folder, outputs;
    std::string points, face = "f";
    for (int i = 0; i < 96'000; ++i) {
        points += "v " + std::to_string(std::cos(i * 6.545e-5)) + " " + std::to_string(std::sin(i * 6.545e-5)) + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    write_text(folder / "x.obj", points + face + "\n");
    const auto start = std::chrono::steady_clock::now();
    check_refused(outputs, {"render", folder / "x.obj", "-o", outputs / "x.pfm", "--size", "8"}, 2,
                  {"x.obj", "face 1", "corners", "the most is 10000"});
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
    write_text(folder / "x.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 4294967299\nproperty float x\nproperty float y\n"
               "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n" +
                   std::string(36, '\0'));
    check_refused(outputs, {"render", folder / "x.ply", "-o", outputs / "x.pfm", "--size", "8"}, 2,
                  {"x.ply", "more elements than raya reads"});
}

TEST_CASE("a driver that crashes or hangs is an error with a remedy; one that fails is left out", "[cli][hostile]") {
    const fs::path pocl = "/etc/OpenCL/vendors/pocl.icd";
    if (!fs::exists(pocl) || kSanitized) return;
    const ScratchFolder vendors, outputs;
    fs::copy_file(pocl, vendors / "pocl.icd");
    write_text(vendors / "bad.icd", RAYA_BAD_DRIVER "\n");
    const Arguments verify = {"verify", "--only", "machine mapping: rows"};
    const auto with_fault = [&](const std::string& fault) -> RunOptions {
        return {.variables = {{"OCL_ICD_VENDORS", vendors.path()}, {"RAYA_BAD_DRIVER", fault}}};
    };
    for (const char* const fault : {"crash platforms", "crash devices", "crash info", "hang devices"}) {
        CAPTURE(fault);
        check_refused(outputs, {"devices"}, 3, {"OCL_ICD_VENDORS"}, with_fault(fault));
    }
    check_refused(outputs, verify, 3, {"OCL_ICD_VENDORS"}, with_fault("crash platforms"));
    for (const char* const fault : {"fail devices", "fail info", ""})
        for (const Arguments& command : {Arguments{"devices"}, verify}) {
            const RunOutcome run = run_raya(command, with_fault(fault));
            INFO(fault << "\n" << run.describe());
            CHECK(run.code == 0);
            CHECK(contains(run.err, "left out") == (fault[0] != '\0'));
            CHECK(contains(run.err, "Bad driver") == (fault[0] != '\0'));
            CHECK_THAT(run.out, Catch::Contains("Portable Computing Language"));
        }
}

TEST_CASE("verify: refuses times that are no times; --reproduce leaves no folders", "[cli][hostile]") {
    const ScratchFolder outputs;
    for (const Arguments& time : {Arguments{"--soak", "-1s"},
                                  {"--soak", "nan"},
                                  {"--timeout", "nan"},
                                  {"--timeout", "-1"},
                                  {"--timeout", "inf"},
                                  {"--repeat", "0"}})
        check_refused(outputs, Arguments{"verify", "--only", "rows", time[0], time[1]}, 2, {time[0]});
    const RunOutcome run =
        run_raya({"verify", "--only", "machine mapping: rows", "--reproduce", outputs / "one/two/three"});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(outputs.entries() == 0);
}

TEST_CASE("every command has --help-all", "[cli][hostile]") {
    for (const char* command : {"render", "devices", "machines", "info", "generate", "bench", "tune", "page", "explore",
                                "verify", "ping", "help"}) {
        const RunOutcome run = run_raya({command, "--help-all"});
        INFO(run.describe());
        CHECK(run.code == 0);
        CHECK_THAT(run.out, Catch::Contains(std::string("raya ") + command));
    }
}

TEST_CASE("JUnit is XML for texts that are not UTF-8", "[cli][hostile]") {
    Check check{"number", "name \xff", 0, {}};
    check.verdict = failed("result \xc3(", {});
    DeviceChecks device{.name = "device \x80", .platform = "p", .version = "v", .driver = "d"};
    device.checks = {check};
    const std::string text = junit_report("raya verify", {device});
    CHECK(json_text(parse_json(json_dump(text), {"text"})) == text);  // only UTF-8
    CHECK_THAT(text, Catch::Contains("name \xef\xbf\xbd"));
}

}  // namespace
}  // namespace raya
