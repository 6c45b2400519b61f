// Meshes on the command line: the example of docs/meshes.md, every command, camera options, reports and refusals.
#include <fmt/core.h>
#include <sys/stat.h>

#include <sstream>

#include "host/base/whole_file.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

using Catch::Contains;

/// Options of a run without OpenCL drivers.
const RunOptions kNoDriver{.variables = {{"OCL_ICD_VENDORS", "/nowhere"}, {"OCL_ICD_FILENAMES", ""}}};

/// The lines of docs/meshes.md with this indentation, without it.
std::vector<std::string> example_lines() {
    std::istringstream page(read_file(RAYA_SOURCE_DIR "/docs/meshes.md"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(page, line);)
        if (line.starts_with("    ")) lines.push_back(line.substr(4));
    return lines;
}

const std::string kExample = "oct.obj";  // the mesh of docs/meshes.md

/// Writes the mesh of docs/meshes.md into the folder and returns its path.
std::string write_example(const ScratchFolder& folder, const std::string& before = "") {
    std::string text = before;
    for (const std::string& line : example_lines())
        if (line.starts_with("v ") || line.starts_with("f ")) text += line + "\n";
    write_whole_file(folder / kExample, text);
    return folder / kExample;
}

TEST_CASE("the example of docs/meshes.md prints what the page shows", "[cli][mesh]") {
    const ScratchFolder folder;
    const std::string mesh = write_example(folder);
    const RunOutcome run = run_raya({"info", mesh}, kNoDriver);
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(run.err.empty());
    int shown_lines = 0;
    for (const std::string& line : example_lines())
        if (line.starts_with(kExample + ": ")) {
            ++shown_lines;
            CHECK_THAT(run.out, Contains(line + "\n"));
        }
    CHECK(shown_lines == 1);
}

TEST_CASE("a mesh renders as the same scene in NFF does; the report lists what was ignored", "[cli][mesh]") {
    const ScratchFolder folder;
    const std::string mesh = write_example(folder, "mtllib none.mtl\n");
    const auto hash_of = [&](const std::string& scene, Arguments options) {
        options.insert(options.begin(), {"render", scene, "-o", folder / "x.pfm", "--report", folder / "x.json",
                                         "--size", "20x12", "--pes", "20", "--lanes", "4"});
        const RunOutcome run = run_raya(options);
        INFO(run.describe());
        REQUIRE(run.code == 0);
        return Document::parse(read_file(folder / "x.json"))["image"]["hash"].get<std::string>();
    };
    const std::string hash = hash_of(mesh, {});
    const Document report = Document::parse(read_file(folder / "x.json"));
    CHECK(report["rays"]["shadow"].get<int>() > 0);  // the mesh is in the image
    REQUIRE(report["skipped"].size() >= 1);
    CHECK(report["skipped"][0]["what"] == "file that cannot be opened, ignored");
    CHECK_THAT(report["skipped"][0]["place"].get<std::string>(), Contains("none.mtl"));
    CHECK(report["warnings"].size() == 1);
    // The scene as NFF, with the camera and lights of the report.
    const Document view = report["view"];
    const auto text_of = [](const Document& vector) {
        return fmt::format("{} {} {}", vector[0].get<double>(), vector[1].get<double>(), vector[2].get<double>());
    };
    std::string nff = fmt::format("b 0 0 0\nv\nfrom {}\nat {}\nup {}\nangle 45\nhither 0\nresolution 256 256\n",
                                  text_of(view["from"]), text_of(view["at"]), text_of(view["up"]));
    for (const Document& light : view["lights"]) nff += "l " + text_of(light["position"]) + "\n";
    std::vector<std::string> vertices;
    for (const std::string& line : example_lines()) {
        if (line.starts_with("v ")) vertices.push_back(line.substr(1));
        if (!line.starts_with("f ")) continue;
        nff += "p 3";
        for (const std::size_t digit : {2, 4, 6}) nff += vertices.at(static_cast<std::size_t>(line.at(digit) - '1'));
        nff += "\n";
    }
    write_whole_file(folder / "t.nff", nff);
    CHECK(hash_of(folder / "t.nff", {}) == hash);
    CHECK(hash_of(mesh, {"--from", "1,1,1", "--at", "0,0,0", "--up", "0,0,1", "--angle", "70", "--light", "3,3,3"}) !=
          hash);
}

TEST_CASE("meshes: refusals name the file and leave no output", "[cli][mesh]") {
    const ScratchFolder folder, outputs;
    write_whole_file(folder / "empty.stl", "solid\nendsolid\n");
    write_whole_file(folder / "bad.ply", "ply\n");
    write_whole_file(folder / "bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n");
    check_refused(outputs, render_into(outputs, folder / "empty.stl"), 2, {"raya: ", "empty.stl: "});
    check_refused(outputs, render_into(outputs, folder / "bad.ply"), 2, {"bad.ply: cannot read the mesh: PLY: "});
    check_refused(outputs, render_into(outputs, folder / "bad.obj"), 2,
                  {"bad.obj: mesh 'defaultobject', face 1: polygon without area, left out",
                   "bad.obj: it has no triangle: the image would be empty"});
    check_refused(outputs, render_into(outputs, folder / "none.glb"), 2,
                  {"none.glb: cannot read the mesh: No such file or directory"});
    const std::string mesh = write_example(folder, "mtllib none.mtl\n");
    check_refused(outputs, render_into(outputs, mesh, {"--strict"}), 2,
                  {kExample + ": file '", "none.mtl': file that cannot be opened has no counterpart in raya"});
}

TEST_CASE("meshes: a crash of the import program ends raya with exit code 2", "[cli][mesh]") {
    const ScratchFolder folder, outputs;
    const std::string mesh = write_example(folder), program = folder / "raya";
    std::filesystem::copy_file(RAYA_PROGRAM, program);
    write_whole_file(folder / "raya_import", "#!/bin/sh\nkill -SEGV $$\n");
    ::chmod((folder / "raya_import").c_str(), 0755);
    check_refused(outputs, render_into(outputs, mesh), 2,
                  {"raya: " + mesh + ": cannot read the mesh: the import process ended with signal 11 (SIGSEGV)"},
                  {.program = program});
}

#ifndef __SANITIZE_ADDRESS__  // AddressSanitizer needs more address space
TEST_CASE("meshes: the import program obeys a limit on memory", "[cli][mesh]") {
    const ScratchFolder folder, outputs;
    std::string mesh;  // assimp needs far more memory than this text
    for (int i = 0; i < 100'000; ++i) mesh += "v 0 0 1\n";
    for (int i = 0; i < 400'000; ++i) mesh += "f 1 2 3\n";
    write_whole_file(folder / "large.obj", mesh);
    check_refused(outputs, {"info", folder / "large.obj"}, 2, {"large.obj: "},
                  {.max_memory_bytes = std::size_t{150} << 20});
}
#endif

}  // namespace
}  // namespace raya
