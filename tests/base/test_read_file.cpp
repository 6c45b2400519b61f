// Reading whole files, and errors for everything that is not a readable file.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <thread>

#include "host/base/whole_file.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {
using Catch::Matchers::Contains;

TEST_CASE("all bytes of a file are read, even if its size is not known", "[read_file]") {
    const ScratchFolder folder;
    std::string bytes(300'001, 'x');
    bytes[7] = '\0';
    std::ofstream(folder / "a", std::ios::binary) << bytes;
    CHECK(read_file(folder / "a") == bytes);
    std::ofstream(folder / "empty");
    CHECK(read_file(folder / "empty").empty());
    CHECK_THAT(read_file("/proc/self/status"), Contains("Name:"));  // its size is reported as 0
}

TEST_CASE("a pipe is read with Pipes::kRead, and otherwise refused without waiting", "[read_file]") {
    const ScratchFolder folder;
    const auto pipe = folder / "pipe";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK_THROWS_WITH(read_file(pipe), "it is a pipe, not a regular file");
    std::thread writer([&] { std::ofstream(pipe) << "from a pipe"; });
    CHECK(read_file(pipe, Pipes::kRead) == "from a pipe");
    writer.join();
}

TEST_CASE("paths that are not files, and files that cannot be read, are refused with the reason", "[read_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "long") << std::string(1000, 'x');
    CHECK_THROWS_WITH(read_file(folder / "none"), "No such file or directory");
    CHECK_THROWS_WITH(read_file(folder.path()), Contains("it is a directory"));
    CHECK_THROWS_WITH(read_file("/dev/zero"), "not a regular file");
    CHECK_THROWS_WITH(read_file("/proc/self/mem"), "Input/output error");
    CHECK_THROWS_WITH(read_file(folder / std::string(300, 'n')), "File name too long");
    CHECK_THROWS_WITH(read_file(folder / "long", Pipes::kRefused, 999), Contains("larger than 999 bytes"));
    CHECK(read_file(folder / "long", Pipes::kRefused, 1000).size() == 1000);
    std::filesystem::create_symlink("loop", folder / "loop");
    CHECK_THROWS_WITH(read_file(folder / "loop"), "Too many levels of symbolic links");
}

}  // namespace
}  // namespace raya
