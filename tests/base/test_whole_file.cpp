// Whole files: reading them, and writing them completely or not at all.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <thread>

#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;
using Catch::Matchers::Contains;

/// For its lifetime, limits the size of this process's files to `bytes`, to simulate a full disk.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit old_{};
    void (*handler_)(int);
};

/// For its lifetime, changes the user root to `nobody`, so that permissions apply. Does nothing for users other than
/// root.
class WithoutRoot {
  public:
    WithoutRoot() : changed_(::geteuid() == 0 && ::seteuid(kNobodyUid) == 0) {}
    WithoutRoot(const WithoutRoot&) = delete;
    WithoutRoot& operator=(const WithoutRoot&) = delete;
    ~WithoutRoot() {
        if (changed_ && ::seteuid(0) != 0) std::abort();
    }

  private:
    static constexpr uid_t kNobodyUid = 65534;
    bool changed_;
};

TEST_CASE("read_file returns all bytes of a file or a pipe, and refuses everything else with the reason",
          "[whole_file]") {
    const ScratchFolder folder;
    std::string bytes(300'001, 'x');
    bytes[7] = '\0';
    std::ofstream(folder / "a", std::ios::binary) << bytes;
    CHECK(read_file(folder / "a") == bytes);
    CHECK(read_file(folder / "a", bytes.size()) == bytes);
    std::ofstream(folder / "empty");
    CHECK(read_file(folder / "empty").empty());
    CHECK_THAT(read_file("/proc/self/status"), Contains("Name:"));  // its size is reported as 0
    REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
    std::thread writer([&] { std::ofstream(folder / "pipe") << "from a pipe"; });
    CHECK(read_file(folder / "pipe") == "from a pipe");
    writer.join();
    CHECK_THROWS_WITH(read_file(folder / "a", 999), Contains("larger than 999 bytes"));
    fs::create_symlink("loop", folder / "loop");
    for (const auto& [path, reason] : {std::pair<fs::path, std::string>{folder / "none", "No such file or directory"},
                                       {folder.path(), "it is a directory, not a file"},
                                       {"/dev/zero", "not a regular file"},
                                       {"/proc/self/mem", "Input/output error"},
                                       {folder / "loop", "Too many levels of symbolic links"}})
        CHECK_THROWS_WITH(read_file(path), reason);
}

TEST_CASE("write_whole_file replaces a file; who has the old file open still reads it", "[whole_file]") {
    const ScratchFolder folder;
    const fs::path file = folder / "f";
    std::ofstream(file) << "old";
    const fs::perms permissions = fs::status(file).permissions();  // the default
    std::ifstream reader(file);
    std::string all;
    for (int i = 0; i < 1000; ++i) all += std::to_string(i) + std::string("\0\xff\n", 3);
    write_whole_file(file, all);
    CHECK(read_file(file) == all);
    CHECK(std::string(std::istreambuf_iterator<char>(reader), {}) == "old");
    CHECK(fs::status(file).permissions() == permissions);
    write_whole_file(file, "");
    CHECK(read_file(file).empty());
    CHECK(folder.entries() == 1);
}

TEST_CASE("a failure while a file is written leaves the old file and no temporary file", "[whole_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "f") << "old";
    {
        const FileSizeLimit limit(4096);
        for (const char* name : {"f", "new"})
            CHECK_THROWS_WITH(write_whole_file(folder / name, std::string(10'000, 'x')),
                              Contains("cannot write") && Contains("File too large") && Contains("ulimit -f"));
    }
    CHECK(read_file(folder / "f") == "old");
    CHECK(folder.entries() == 1);
}

TEST_CASE("write_whole_file follows links to files, and writes devices and pipes directly", "[whole_file]") {
    const ScratchFolder folder;
    fs::create_directory(folder / "elsewhere");
    std::ofstream(folder / "elsewhere/real") << "old";
    fs::create_symlink("elsewhere/real", folder / "link");
    write_whole_file(folder / "link", "new");
    CHECK(fs::is_symlink(folder / "link"));
    CHECK(read_file(folder / "elsewhere/real") == "new");
    fs::create_symlink("nothing", folder / "dangling");
    write_whole_file(folder / "dangling", "new");
    CHECK(!fs::is_symlink(folder / "dangling"));
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    write_whole_file("plain", "1");
    fs::current_path(before);
    CHECK(read_file(folder / "plain") == "1");
    write_whole_file("/dev/null", "nothing");
    CHECK(fs::is_character_file("/dev/null"));
    CHECK_THROWS_WITH(write_whole_file("/dev/full", "x"),
                      Contains("/dev/full") && Contains("No space left on device") && Contains("another disk"));
}

TEST_CASE("no output is an input or another output, under any of its names", "[whole_file]") {
    const ScratchFolder folder;
    fs::create_directory(folder / "there");
    fs::create_directory_symlink("there", folder / "alias");
    std::ofstream(folder / "there/in") << "input";
    fs::create_hard_link(folder / "there/in", folder / "hard");
    fs::create_symlink("there/in", folder / "link");
    register_input(folder / "there/in", "SCENE in");
    for (const char* name : {"there/./in", "alias/in", "hard", "link", "there/../link"}) {
        CAPTURE(name);
        CHECK_THROWS_WITH(promise_output(folder / name, "--output"),
                          "--output: would overwrite the input SCENE in; "
                          "name another file");
        CHECK_THROWS_AS(write_whole_file(folder / name, "x"), UserError);
    }
    CHECK(read_file(folder / "there/in") == "input");
    promise_output(folder / "there/out", "--output");
    for (const char* name : {"there/./out", "alias/out", "there/../alias//out"}) {
        CHECK_THROWS_WITH(promise_output(folder / name, "--report"), Contains("--report: the same file as --output"));
        CHECK_NOTHROW(promise_output(folder / name, "--output"));
    }
    promise_output(folder / "there/other", "--report");
    promise_output(folder / "none/out", "--page");
    forget_promised_outputs();
    forget_input(folder / "link");
    write_whole_file(folder / "link", "new");
}

TEST_CASE("an output file that cannot be written is refused with file, reason and remedy", "[whole_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "file") << "x";
    fs::create_symlink("loop", folder / "loop");
    for (const auto& [path, reason, remedy] :
         {std::tuple<fs::path, const char*, const char*>{folder / "missing/x", "missing' does not exist", "mkdir -p"},
          {folder / "file/x", "is not a folder", "name a file in another folder"},
          {folder.path(), "it is a folder", "name a file in it"},
          {folder / "missing/", "it is a folder", "name a file in it"},
          {folder / std::string(300, 'n'), "File name too long", "name another file"},
          {folder / "loop", "Too many levels of symbolic links", "name another file"},
          {folder / "loop/x", "Too many levels of symbolic links", "name another file"}}) {
        CAPTURE(path);
        CHECK_THROWS_WITH(check_writable(path), Contains(path.string()) && Contains(reason) && Contains(remedy));
        CHECK_THROWS_AS(write_whole_file(path, "x"), UserError);
    }
    check_writable(folder / "new");
    CHECK(folder.entries() == 2);  // nothing was written
}

TEST_CASE("missing permissions are an error and change nothing", "[whole_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "old") << "old";
    fs::permissions(folder / "old", fs::perms(0444));
    const auto check_refused = [&](const char* name, const char* reason) {
        const WithoutRoot no_root;
        CHECK_THROWS_WITH(check_writable(folder / name), Contains(reason) && Contains("change its permissions"));
        CHECK_THROWS_AS(write_whole_file(folder / name, "new"), UserError);
    };
    ::chmod(folder.path().c_str(), 0777);
    check_refused("old", "exists and is not writable");
    ::chmod(folder.path().c_str(), 0555);
    check_refused("x", "is not writable");
    ::chmod(folder.path().c_str(), 0755);
    CHECK(read_file(folder / "old") == "old");
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
