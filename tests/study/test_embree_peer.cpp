// What embree_peer tells, read from what it prints and asked of programs that stand in for it.
#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "host/base/whole_file.hpp"
#include "host/study/embree_peer.hpp"
#include "host/study/peer.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/study/small_page.hpp"

namespace raya {
namespace {
using Catch::Matchers::Contains;

constexpr const char* kPrinted =
    "single 93312 0.004500 0.004100 0.004300\n"
    "mean single 0.1 0.2 0.3\n"
    "sixteen 93310 0.003000 0.003200 0.003100\n"
    "mean sixteen 0.1 0.2 0.3\n"
    "build 0.000800\n";

std::string stand_in(const ScratchFolder& folder, const std::string& body) {
    const std::filesystem::path program = folder / "peer";
    write_whole_file(program, "#!/bin/sh\n" + body + "\n");
    ::chmod(program.c_str(), 0755);
    return program;
}

std::string failure_of(const std::string& body) {
    const ScratchFolder folder;
    try {
        ask_embree(stand_in(folder, body), "scene", {.side = 8});
    } catch (const PeerFailure& failure) {
        return failure.what();
    }
    return "none";
}

TEST_CASE("each way's rays and samples are read, and the time of the build", "[study]") {
    const PeerAnswer answer = peer_answer(kPrinted);
    REQUIRE(answer.ways.size() == 2);
    CHECK(answer.ways[0].name == "single");
    CHECK(answer.ways[0].rays == 93312);
    CHECK(answer.ways[0].seconds == std::vector{0.0045, 0.0041, 0.0043});
    CHECK(answer.ways[1].name == "sixteen");
    CHECK(answer.ways[1].rays == 93310);
    CHECK(answer.ways[1].seconds == std::vector{0.003, 0.0032, 0.0031});
    CHECK(answer.build_s == 0.0008);
}

TEST_CASE("what is no answer is refused, however near to one", "[study]") {
    for (const char* printed :
         {"", "build 0.1\n", "single 7 0.1\n", "single 7 0.1\nbuild soon\n", "single\nbuild 0.1\n",
          "single 7\nbuild 0.1\n", "single 0 0.1\nbuild 0.1\n", "single 7 -0.1\nbuild 0.1\n",
          "single 7 0.1 x\nbuild 0.1\n", "single x 0.1\nbuild 0.1\n"}) {
        CAPTURE(printed);
        CHECK_THROWS_AS(peer_answer(printed), PeerFailure);
    }
}

TEST_CASE("the program is given the scene, the size, the bounces and the samples", "[study]") {
    const ScratchFolder folder;
    const std::string program =
        stand_in(folder, "cp \"$1\" " + (folder / "scene").string() + "; shift; echo \"$@\" > " +
                             (folder / "words").string() + "; echo 'single 7 0.5'; echo 'build 0.25'");
    const PeerAnswer answer = ask_embree(program, "the scene's text", {.side = 48, .bounces = 3, .samples = 2});
    CHECK(answer.ways.front().rays == 7);
    CHECK(contents_of(folder / "scene") == "the scene's text");
    CHECK(contents_of(folder / "words") == "48x48 3 centres 2\n");
}

TEST_CASE("a program that fails is told of in its own words, else by how it ended", "[study]") {
    CHECK_THAT(failure_of("echo 'embree_peer: a checker on a cone' >&2; exit 2"), Contains("a checker on a cone"));
    CHECK(failure_of("exit 3") == "peer: exit code 3");
    CHECK(failure_of("kill -11 $$") == "peer: signal 11 (SIGSEGV)");
    CHECK_THAT(failure_of("exit 0"), Contains("does not tell its times"));
    CHECK_THROWS_WITH(ask_embree("/nowhere/peer", "scene", {.side = 8}), Contains("peer: No such file"));
}

}  // namespace
}  // namespace raya
