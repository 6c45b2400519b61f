// Files are written completely or not at all: after every failure the folder is unchanged.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <string>
#include <string_view>

#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;
using Catch::Matchers::Contains;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

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

TEST_CASE("write_whole_file writes all bytes and nothing else", "[whole_file]") {
    const ScratchFolder folder;
    const std::string bytes("a\0b\xff\n", 5);
    write_whole_file(folder / "report.json", bytes);
    CHECK(contents(folder / "report.json") == bytes);
    CHECK(folder.entries() == 1);
}

TEST_CASE("write_whole_file writes a file given in pieces", "[whole_file]") {
    const ScratchFolder folder;
    int pieces = 0;
    std::string piece;
    write_whole_file(folder / "a", [&]() -> std::string_view {
        piece = pieces < 1000 ? std::to_string(pieces++) + "\n" : "";
        return piece;
    });
    const std::string written = contents(folder / "a");
    CHECK(written.starts_with("0\n1\n2\n"));
    CHECK(written.ends_with("998\n999\n"));
    CHECK(written.size() == 10 * 2 + 90 * 3 + 900 * 4);
    write_whole_file(folder / "a", "");
    CHECK(contents(folder / "a").empty());
}

TEST_CASE("an exception while making a piece leaves the old file and no temporary file", "[whole_file]") {
    const ScratchFolder folder;
    const fs::path file = folder / "x";
    write_whole_file(file, "old");
    int calls = 0;
    const auto next = [&]() -> std::string_view {
        if (++calls == 3) throw std::bad_alloc();
        return "new";
    };
    CHECK_THROWS_AS(write_whole_file(file, next), std::bad_alloc);
    CHECK(contents(file) == "old");
    CHECK(folder.entries() == 1);
}

TEST_CASE("write_whole_file creates files with the default permissions", "[whole_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "other") << "x";
    write_whole_file(folder / "report", "x");
    CHECK(fs::status(folder / "report").permissions() == fs::status(folder / "other").permissions());
}

TEST_CASE("write_whole_file replaces an old file; processes that have the old file open still read its content",
          "[whole_file]") {
    const ScratchFolder folder;
    write_whole_file(folder / "f", std::string(100'000, 'x'));
    std::ifstream reader(folder / "f");  // a reader of the old file
    write_whole_file(folder / "f", "short");
    CHECK(contents(folder / "f") == "short");
    CHECK(std::string(std::istreambuf_iterator<char>(reader), {}).size() == 100'000);
    CHECK(folder.entries() == 1);
}

TEST_CASE("write_whole_file accepts names relative to the working folder", "[whole_file]") {
    const ScratchFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    write_whole_file("plain", "1");
    fs::current_path(before);
    CHECK(contents(folder / "plain") == "1");
}

TEST_CASE("write_whole_file follows symbolic links", "[whole_file]") {
    const ScratchFolder folder;
    fs::create_directory(folder / "elsewhere");
    std::ofstream(folder / "elsewhere/real") << "old";
    fs::create_symlink("elsewhere/real", folder / "link");
    write_whole_file(folder / "link", "new");
    CHECK(fs::is_symlink(folder / "link"));
    CHECK(contents(folder / "elsewhere/real") == "new");
}

TEST_CASE("write_whole_file writes through a link to a file that does not exist yet", "[whole_file]") {
    const ScratchFolder folder;
    fs::create_directory(folder / "there");
    fs::create_symlink("there/new", folder / "link");
    fs::create_symlink(folder / "link", folder / "link to link");
    write_whole_file(folder / "link to link", "x");
    CHECK(contents(folder / "there/new") == "x");
    CHECK(fs::is_symlink(folder / "link"));
    CHECK(fs::is_symlink(folder / "link to link"));
    fs::create_symlink("nowhere/new", folder / "lost");
    CHECK_THROWS_WITH(write_whole_file(folder / "lost", "x"), Contains("nowhere' does not exist"));
}

TEST_CASE("file_identity is equal for all names of a file, existing or not", "[whole_file]") {
    const ScratchFolder folder;
    fs::create_directory(folder / "there");
    fs::create_directory_symlink("there", folder / "alias");
    fs::create_symlink("there/new", folder / "link");
    const fs::path before = fs::current_path();
    for (const bool exists : {false, true}) {
        CAPTURE(exists);
        if (exists) write_whole_file(folder / "there/new", "x");
        const std::string file = file_identity(folder / "there/new");
        for (const char* name :
             {"there/./new", "alias/new", "link", "there/../there/new", "alias/../link", "there//new"}) {
            CAPTURE(name);
            CHECK(file_identity(folder / name) == file);
        }
        CHECK(file_identity(folder / "there/old") != file);
        fs::current_path(folder / "there");
        CHECK(file_identity("new") == file);
        CHECK(file_identity("./new") == file);
        fs::current_path(before);
    }
    fs::create_hard_link(folder / "there/new", folder / "hard");
    CHECK(file_identity(folder / "hard") == file_identity(folder / "there/new"));
    CHECK(file_identity(folder / "none/new") == file_identity(folder / "none/./new"));
    CHECK(file_identity(folder / "none/new") != file_identity(folder / "none/old"));
    for (const std::string& path : {std::string("/dev/null"), std::string(folder / "there")})
        CHECK(file_identity(path).empty());
}

TEST_CASE("write_whole_file writes a device or a pipe directly", "[whole_file]") {
    write_whole_file("/dev/null", "nothing");
    CHECK(fs::is_character_file("/dev/null"));
    CHECK_THROWS_WITH(write_whole_file("/dev/full", "x"),
                      Contains("/dev/full") && Contains("No space left on device") && Contains("another disk"));
    CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("a full disk leaves the old file and no temporary file", "[whole_file]") {
    const ScratchFolder folder;
    write_whole_file(folder / "f", "old");
    {
        const FileSizeLimit limit(4096);
        CHECK_THROWS_WITH(write_whole_file(folder / "f", std::string(10'000, 'x')),
                          Contains("cannot write") && Contains("File too large") && Contains("ulimit -f"));
        CHECK_THROWS_AS(write_whole_file(folder / "new", std::string(10'000, 'x')), UserError);
    }
    CHECK(contents(folder / "f") == "old");
    CHECK(folder.entries() == 1);
}

TEST_CASE("an output file that cannot be written is refused with file, reason and remedy", "[whole_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "file") << "x";
    const auto check_refused = [](const fs::path& path, const std::string& reason, const std::string& remedy) {
        CHECK_THROWS_WITH(check_writable(path), Contains(path.string()) && Contains(reason) && Contains(remedy));
        CHECK_THROWS_WITH(write_whole_file(path, "x"), Contains(reason) && Contains(remedy));
        CHECK_THROWS_AS(write_whole_file(path, "x"), UserError);
    };
    check_refused(folder / "missing/x", "missing' does not exist", "mkdir -p");
    check_refused(folder / "file/x", "is not a folder", "name a file in another folder");
    check_refused(folder.path(), "it is a folder", "name a file in it");
    check_refused(folder / "missing/", "it is a folder", "name a file in it");
    check_refused("", "the name is empty", "name a file");
    CHECK_THROWS_WITH(write_whole_file(folder / std::string(300, 'n'), "x"), Contains("File name too long"));
    CHECK(folder.entries() == 1);
}

TEST_CASE("invalid file names are refused with the reason", "[whole_file]") {
    const ScratchFolder folder;
    fs::create_symlink("loop", folder / "loop");
    for (const auto& [name, reason] : {std::pair<std::string, std::string>{std::string(300, 'n'), "File name too long"},
                                       {"loop", "Too many levels of symbolic links"},
                                       {"loop/x", "Too many levels of symbolic links"}}) {
        CAPTURE(name);
        CHECK_THROWS_AS(write_whole_file(folder / name, "x"), UserError);
        CHECK_THROWS_WITH(check_writable(folder / name), Contains(name) && Contains(reason));
    }
}

TEST_CASE("missing permissions are an error and change nothing", "[whole_file]") {
    const ScratchFolder folder;
    std::ofstream(folder / "old") << "old";
    fs::permissions(folder / "old", fs::perms(0444));
    ::chmod(folder.path().c_str(), 0777);
    {
        const WithoutRoot no_root;
        CHECK_THROWS_WITH(check_writable(folder / "old"), Contains("exists and is not writable"));
        CHECK_THROWS_AS(write_whole_file(folder / "old", "new"), UserError);
    }
    ::chmod(folder.path().c_str(), 0555);
    {
        const WithoutRoot no_root;
        CHECK_THROWS_WITH(check_writable(folder / "x"), Contains("is not writable") && Contains("permissions"));
        CHECK_THROWS_AS(write_whole_file(folder / "x", "new"), UserError);
    }
    ::chmod(folder.path().c_str(), 0755);
    CHECK(contents(folder / "old") == "old");
    CHECK(folder.entries() == 1);
}

TEST_CASE("check_writable writes nothing", "[whole_file]") {
    const ScratchFolder folder;
    check_writable(folder / "x");
    CHECK(folder.entries() == 0);
}

}  // namespace
}  // namespace raya
