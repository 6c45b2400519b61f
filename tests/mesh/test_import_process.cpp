// Faults of the import process: it crashes, hangs, is missing, or sends wrong data. A script takes its place.
#include <sys/stat.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/json.hpp"
#include "host/base/module.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/mesh/mesh_files.hpp"
#include "tests/paths.h"

namespace raya {
namespace {

using Catch::Contains;

/// A folder in which raya finds a script instead of the program raya_import.
class FakeImport {
  public:
    explicit FakeImport(const std::string& script) {
        write_whole_file(folder_ / "raya", "");
        write_whole_file(folder_ / "t.obj", tetrahedron_obj());
        if (!script.empty()) {
            write_whole_file(folder_ / "raya_import", "#!/bin/sh\n" + script + "\n");
            ::chmod((folder_ / "raya_import").c_str(), 0755);
        }
        set_program_file(folder_ / "raya");
    }
    ~FakeImport() { set_program_file(RAYA_PROGRAM); }

    /// Returns the error of reading a mesh, without the folder; "read" if there is none.
    std::string error() const {
        try {
            std::vector<SceneRemark> remarks;
            read_scene_file(folder_ / "t.obj", &remarks);
            return "read";
        } catch (const UserError& error) {
            return replaced(error.what(), folder_.path().string() + "/", "");
        }
    }

    ScratchFolder folder_;
};

/// A document with a surface and a mesh, whose faces are kFaceBytes.
Json good_document() {
    return {{"files", Json::array()},
            {"ignored", Json::array({Json::array({"camera", ""})})},
            {"surfaces", Json::array({Json::array({"paint", 1, 1, 1, 1, 0, 0, 0, 1})})},
            {"meshes", Json::array({{{"name", "tetra"}, {"surface", 1}, {"faces", 4}, {"has_normals", false}}})}};
}

std::string face_bytes() {
    std::string bytes;
    for (const auto& face : kFaces) {
        append(bytes, std::uint32_t{3});
        for (const std::uint32_t corner : face)
            for (const float x : kCorners[corner]) append(bytes, x);
    }
    return bytes;
}

std::string bytes_of(const Json& document) {
    const std::vector<std::uint8_t> cbor = Json::to_cbor(document);
    std::string bytes;
    append(bytes, std::uint64_t{cbor.size()});
    return bytes.append(cbor.begin(), cbor.end());
}

std::string error_of_bytes(const std::string& bytes) {
    const FakeImport fake("cat \"$0.bytes\" >/proc/self/fd/$1; sleep 0.01");
    write_whole_file(fake.folder_ / "raya_import.bytes", bytes);
    return fake.error();
}

/// Returns the error of good_document() with the value at a JSON pointer replaced.
std::string error_with(const std::string& pointer, const Json& value) {
    Json document = good_document();
    document[Json::json_pointer(pointer)] = value;
    return error_of_bytes(bytes_of(document) + face_bytes());
}

TEST_CASE("a crash or an early end of the import process is a user error", "[mesh]") {
    CHECK(FakeImport("kill -SEGV $$").error() ==
          "t.obj: cannot read the mesh: the import process ended with signal 11 (SIGSEGV); the file may be damaged");
    CHECK_THAT(FakeImport("exit 3").error(), Contains("ended with exit code 3"));
    CHECK_THAT(FakeImport("exit 127").error(), Contains("t.obj: cannot read meshes: raya_import does not start"));
    CHECK_THAT(FakeImport("").error(), Contains("t.obj: cannot read meshes: there is no file '") &&
                                           Contains("remedy: use a complete installation"));
    FakeImport writable("exit 0");
    ::chmod((writable.folder_ / "raya_import").c_str(), 0777);
    CHECK_THAT(writable.error(), Contains("refused to load") && Contains("other users may write"));
}

TEST_CASE("an import process that hangs is ended after RAYA_MESH_TIMEOUT seconds", "[mesh]") {
    ::setenv("RAYA_MESH_TIMEOUT", "1", 1);
    const FakeImport fake("sleep $3; kill -ALRM $$");  // as the alarm of raya_import
    CHECK(fake.error() ==
          "t.obj: reading the mesh takes more than 1 s; the file may be damaged; remedy for a large file: set "
          "RAYA_MESH_TIMEOUT");
    const std::string pipe = fake.folder_ / "pipe.ply";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    const std::string program = std::filesystem::path(RAYA_PROGRAM).parent_path() / "raya_import";
    const int status = std::system(("exec '" + program + "' 1 " + pipe + " 1").c_str());  // waits for a writer
    CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM));
    for (const char* text : {"0", "x", "-1", "1e9", "9999999999"}) {
        ::setenv("RAYA_MESH_TIMEOUT", text, 1);
        CHECK_THAT(fake.error(), Contains(std::string("RAYA_MESH_TIMEOUT=") + text + ": must be a number of seconds"));
    }
    ::unsetenv("RAYA_MESH_TIMEOUT");
}

TEST_CASE("what the import process sends is checked", "[mesh]") {
    const std::string good = bytes_of(good_document()) + face_bytes();
    CHECK(error_of_bytes(good) == "read");
    CHECK(error_of_bytes(bytes_of({{"error", "why"}})) == "t.obj: cannot read the mesh: why");
    CHECK_THAT(error_of_bytes(good.substr(0, good.size() - 1)), Contains("ended with exit code 0"));
    CHECK_THAT(error_with("/meshes/0/faces", 5), Contains("ended with exit code 0"));
    CHECK(error_with("/meshes", Json::array()) == "t.obj: it has no triangle: the image would be empty");
    const std::string invalid = "t.obj: the import process sends invalid data";
    CHECK_THAT(error_of_bytes(std::string(8, '\xff')), Catch::StartsWith(invalid));
    CHECK_THAT(error_of_bytes(bytes_of(3)), Catch::StartsWith(invalid));
    for (const auto& [pointer, value] : std::vector<std::pair<std::string, Json>>{{"/meshes/0/surface", 2},
                                                                                  {"/meshes/0/faces", 1ull << 60},
                                                                                  {"/meshes/0/has_normals", 1},
                                                                                  {"/surfaces/0", {"paint", 1}},
                                                                                  {"/ignored/0", 7},
                                                                                  {"/files", "x"}}) {
        CAPTURE(pointer);
        CHECK_THAT(error_with(pointer, value), Catch::StartsWith(invalid));
    }
    std::string large_face = bytes_of(good_document());
    append(large_face, UINT32_MAX);
    CHECK_THAT(error_of_bytes(large_face), Catch::StartsWith("t.obj: mesh 'tetra', face 1: it has 4294967295 corners"));
    const std::vector<std::pair<const char*, double>> numbers = {
        {"2", -1}, {"3", std::nan("")}, {"4", 101}, {"5", std::nan("")}, {"6", -1}, {"7", -0.5}, {"8", 0}};
    for (const auto& [index, value] : numbers)
        CHECK_THAT(error_with(std::string("/surfaces/0/") + index, value),
                   Contains("t.obj: material 'paint': a number is negative, too large or not finite: colour "));
}

TEST_CASE("mutated data are either accepted or refused with the file's name", "[mesh]") {
    const std::string good = bytes_of(good_document()) + face_bytes();
    const FakeImport fake("cat \"$0.bytes\" >/proc/self/fd/$1");
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        SplitMix random(seed);
        std::string bytes = good;
        for (std::uint64_t changes = 1 + random.next() % 3; changes > 0; --changes)
            bytes[random.next() % bytes.size()] = static_cast<char>(random.next() % 256);
        write_whole_file(fake.folder_ / "raya_import.bytes", bytes);
        CAPTURE(seed);
        const std::string error = fake.error();
        CHECK((error == "read" || error.starts_with("t.obj: ")));
    }
}

}  // namespace
}  // namespace raya
