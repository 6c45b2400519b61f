// Faults of the import process: it crashes, hangs, is missing, or sends wrong records. A script takes its place.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/module.hpp"
#include "host/mesh/import_records.hpp"
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
            write_whole_file(folder_ / kImportProgram, "#!/bin/sh\n" + script + "\n");
            ::chmod((folder_ / kImportProgram).c_str(), 0755);
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

std::string text_record(const std::string& text) {
    std::string bytes;
    append(bytes, static_cast<std::uint32_t>(text.size()));
    return bytes + text;
}

std::string kind(ImportRecord record) {
    std::string bytes;
    append(bytes, record);
    return bytes;
}

std::string mesh_record(const ImportedMesh& header, const std::vector<std::uint32_t>& sizes,
                        const std::vector<std::uint32_t>& corners) {
    std::string bytes = kind(ImportRecord::kMesh) + text_record("tetra");
    append(bytes, header);
    for (const auto& v : kCorners)
        for (const float x : v) append(bytes, x);
    for (const std::uint32_t size : sizes) append(bytes, size);
    for (const std::uint32_t corner : corners) append(bytes, corner);
    return bytes;
}

std::string surface_record(const ImportedSurface& surface) {
    std::string bytes = kind(ImportRecord::kSurface) + text_record("paint");
    append(bytes, surface);
    return bytes;
}

const ImportedMesh kTwoFaces{4, 0, 2, 6, 0};
const std::string kStart = kind(ImportRecord::kStart), kEnd = kind(ImportRecord::kEnd);

std::string error_of_records(const std::string& records) {
    const FakeImport fake("cat \"$0.records\" >/proc/self/fd/$1; sleep 0.01");
    write_whole_file(fake.folder_ / "raya_import.records", records);
    return fake.error();
}

TEST_CASE("a crash or an early end of the import process is a user error", "[mesh]") {
    CHECK(FakeImport("kill -SEGV $$").error() ==
          "t.obj: cannot read the mesh: the import process ended with signal 11 (SIGSEGV); the file may be damaged");
    CHECK_THAT(FakeImport("kill -ABRT $$").error(), Contains("ended with signal 6 (SIGABRT)"));
    CHECK_THAT(FakeImport("exit 3").error(), Contains("ended with exit code 3"));
    CHECK_THAT(FakeImport("exit 127").error(), Contains("t.obj: cannot read meshes: raya_import does not start"));
    CHECK_THAT(FakeImport("").error(), Contains("t.obj: cannot read meshes: there is no file '") &&
                                           Contains("remedy: use a complete installation"));
    FakeImport writable("exit 0");
    ::chmod((writable.folder_ / kImportProgram).c_str(), 0777);
    CHECK_THAT(writable.error(), Contains("refused to load") && Contains("other users may write"));
}

TEST_CASE("an import process that hangs is ended after RAYA_MESH_TIMEOUT seconds", "[mesh]") {
    ::setenv("RAYA_MESH_TIMEOUT", "1", 1);
    const FakeImport fake("echo $$ >\"$0.pid\"; exec sleep 1000");
    CHECK(fake.error() ==
          "t.obj: reading the mesh takes more than 1 s; the file may be damaged; remedy for a large file: set "
          "RAYA_MESH_TIMEOUT");
    const std::string pid = read_file(fake.folder_ / "raya_import.pid");
    CHECK_FALSE(std::filesystem::exists("/proc/" + pid.substr(0, pid.find('\n'))));
    for (const char* text : {"0", "x", "-1", "1e9", "9999999999"}) {
        ::setenv("RAYA_MESH_TIMEOUT", text, 1);
        CHECK_THAT(fake.error(), Contains(std::string("RAYA_MESH_TIMEOUT=") + text + ": must be a number of seconds"));
    }
    ::unsetenv("RAYA_MESH_TIMEOUT");
}

TEST_CASE("records of the import process are checked", "[mesh]") {
    const std::vector<std::uint32_t> sizes = {3, 3}, corners = {0, 1, 2, 0, 1, 3};
    const std::string good = mesh_record(kTwoFaces, sizes, corners);
    CHECK(error_of_records(kStart + good + kEnd) == "read");
    CHECK(error_of_records(kStart + surface_record({}) + good + kEnd) == "read");
    CHECK(error_of_records(kStart + kEnd) == "t.obj: it has no triangle: the image would be empty");
    CHECK(error_of_records(kStart + kind(ImportRecord::kError) + text_record("why")) ==
          "t.obj: cannot read the mesh: why");
    CHECK_THAT(error_of_records(kStart + good), Contains("ended with exit code 0"));
    const std::string invalid = "t.obj: the import process sends an invalid record";
    CHECK(error_of_records(good) == invalid);
    CHECK(error_of_records(kStart + "none") == invalid);
    CHECK(error_of_records(kStart + mesh_record({4, 3, 2, 6, 0}, sizes, corners)) == invalid);
    CHECK(error_of_records(kStart + mesh_record({4, 0, 2, 6, 1}, sizes, corners)) == invalid);
    CHECK(error_of_records(kStart + mesh_record({4, 0, 1ull << 60, 6, 0}, sizes, corners)) == invalid);
    std::string long_text = kStart + kind(ImportRecord::kError);
    append(long_text, kMaxImportedText + 1);
    CHECK(error_of_records(long_text) == invalid);
    CHECK_THAT(error_of_records(kStart + mesh_record({4, 0, UINT32_MAX, UINT32_MAX, 0}, sizes, corners)),
               Contains("ended with exit code 0"));
    CHECK(error_of_records(kStart + mesh_record(kTwoFaces, {3, 4}, corners)) ==
          "t.obj: a mesh has faces with more corners than it lists");
    CHECK(error_of_records(kStart + mesh_record(kTwoFaces, sizes, {0, 1, 2, 0, 1, 4})) ==
          "t.obj: mesh 'tetra', face 2: there is no vertex 4; the mesh has 4, numbered from 0; the file may be "
          "damaged");
}

TEST_CASE("numbers of materials are checked", "[mesh]") {
    const auto check = [](auto change) {
        ImportedSurface surface;
        change(surface);
        CHECK_THAT(error_of_records(kStart + surface_record(surface) + kEnd),
                   Contains("t.obj: material 'paint': a number is negative, too large or not finite: colour "));
    };
    check([](ImportedSurface& s) { s.colour[1] = -1; });
    check([](ImportedSurface& s) { s.colour[2] = std::nanf(""); });
    check([](ImportedSurface& s) { s.diffuse = 101; });
    check([](ImportedSurface& s) { s.specular = std::nanf(""); });
    check([](ImportedSurface& s) { s.shine = -1; });
    check([](ImportedSurface& s) { s.transmittance = -0.5f; });
    check([](ImportedSurface& s) { s.refraction_index = 0; });
}

TEST_CASE("mutated records are either accepted or refused with the file's name", "[mesh]") {
    const std::string good = kStart + surface_record({}) + mesh_record({4, 0, 2, 6, 1}, {3, 3}, {0, 1, 2, 0, 1, 3}) +
                             kind(ImportRecord::kIgnored) + text_record("camera") + text_record("") + kEnd;
    const FakeImport fake("cat \"$0.records\" >/proc/self/fd/$1");
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        SplitMix random(seed);
        std::string records = good;
        for (std::uint64_t changes = 1 + random.next() % 3; changes > 0; --changes)
            records[random.next() % records.size()] = static_cast<char>(random.next() % 256);
        write_whole_file(fake.folder_ / "raya_import.records", records);
        CAPTURE(seed);
        const std::string error = fake.error();
        CHECK((error == "read" || error.starts_with("t.obj: ")));
    }
}

}  // namespace
}  // namespace raya
