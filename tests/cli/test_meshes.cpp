// Meshes on the command line: the example of docs/meshes.md, equal images, and files of somebody who wishes ill.
#include <fmt/core.h>
#include <sys/stat.h>

#include <sstream>

#include "host/base/whole_file.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

using Catch::Contains;
namespace fs = std::filesystem;

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

constexpr const char *kTriangle = "usemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", *kMaterial = "newmtl a\nKd 1 0 0\n";

TEST_CASE("no output overwrites a file that a mesh names", "[cli][hostile]") {
    const ScratchFolder inputs, outputs;
    const std::string image = outputs / "x.pfm", mesh = inputs / "x.obj", material = inputs / "m.mtl";
    write_whole_file(mesh, std::string("mtllib m.mtl\n") + kTriangle);
    write_whole_file(material, kMaterial);
    fs::create_hard_link(material, inputs / "other.json");
    write_whole_file(inputs / "b.bin", std::string(36, '\0'));
    write_whole_file(inputs / "x.gltf",
                     R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": "b.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})");
    for (const Arguments& arguments : {Arguments{"render", mesh, "-o", image, "--report", material},
                                       {"render", mesh, "-o", image, "--report", inputs / "other.json"},
                                       {"render", inputs / "x.gltf", "-o", image, "--report", inputs / "b.bin"}}) {
        const std::string before = file_contents(arguments.back());
        check_refused(outputs, arguments, 2, {*(arguments.end() - 2), "would overwrite the input"});
        CHECK(file_contents(arguments.back()) == before);
    }
}

TEST_CASE("meshes: files outside the mesh's folder are refused, pipes are not opened", "[cli][hostile]") {
    const ScratchFolder folder, outputs;
    fs::create_directory(folder / "mesh");
    write_whole_file(folder / "m.mtl", kMaterial);
    fs::create_symlink(folder / "m.mtl", folder / "mesh/link.mtl");
    REQUIRE(::mkfifo((folder / "mesh/pipe.mtl").c_str(), 0600) == 0);
    for (const std::string library : {"../m.mtl", "link.mtl", "pipe.mtl"}) {
        write_whole_file(folder / "mesh/x.obj", "mtllib " + library + "\n" + kTriangle);
        const RunOutcome run = run_raya({"info", folder / "mesh/x.obj"}, {.variables = {{"RAYA_MESH_TIMEOUT", "60"}}});
        INFO(run.describe());
        CHECK(run.code == (library == "pipe.mtl" ? 0 : 2));
        CHECK_THAT(run.err, Contains(library) && Contains(library == "pipe.mtl" ? "" : "is not in the mesh's folder"));
    }
}

TEST_CASE("meshes: a face of 96,000 corners is refused at once", "[cli][hostile]") {
    const ScratchFolder folder, outputs;
    std::string points, face = "f";
    for (int i = 0; i < 96'000; ++i) {
        points += "v " + std::to_string(std::cos(i * 6.545e-5)) + " " + std::to_string(std::sin(i * 6.545e-5)) + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    write_whole_file(folder / "x.obj", points + face + "\n");
    check_refused(outputs, {"info", folder / "x.obj"}, 2, {"x.obj", "face 1", "corners", "the most is 10000"},
                  {.variables = {{"RAYA_MESH_TIMEOUT", "20"}}});
    write_whole_file(
        folder / "x.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 4294967299\nproperty float x\nproperty float y\n"
        "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n" +
            std::string(36, '\0'));
    check_refused(outputs, {"info", folder / "x.ply"}, 2, {"x.ply", "more elements than raya reads"});
}

}  // namespace
}  // namespace raya
