// Security: raya loads no module, and uses no kernel cache, that other users can write.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/cli/refusals.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;
using Catch::Contains;

constexpr uid_t kNobody = 65534;

const fs::path kBuild = fs::path(RAYA_PROGRAM).parent_path();

/// A copy of raya in `program_in` and of its modules in `modules_in`, two subfolders of `folder`.
struct Installation {
    Installation(const fs::path& folder, const char* program_in, const char* modules_in)
        : top(folder),
          program((folder / program_in / "raya").lexically_normal()),
          modules((folder / modules_in / "x").lexically_normal().parent_path()) {
        fs::create_directories(program.parent_path());
        fs::create_directories(modules);
        fs::copy_file(RAYA_PROGRAM, program);
        for (const char* name : {"raya_pictures.so", "raya_mpi.so"})
            if (fs::exists(kBuild / name)) fs::copy_file(kBuild / name, modules / name);
        for (const auto& entry : fs::recursive_directory_iterator(folder)) ::chmod(entry.path().c_str(), 0755);
        ::chmod(folder.c_str(), 0755);
    }

    RunOutcome run(bool as_nobody = false) const {
        const ScratchFolder outputs;
        ::chmod(outputs.path().c_str(), 0777);
        return run_raya(
            {"render", scene_file("planes"), "-o", outputs / "x.tif", "--size", "8", "--pes", "8", "--lanes", "4",
             "-q"},
            {.variables = {{"POCL_CACHE_DIR", as_nobody ? outputs.path().string() : ::getenv("POCL_CACHE_DIR")}},
             .as_nobody = as_nobody,
             .program = program});
    }

    /// Runs raya as one of two ranks. It loads the MPI module, then fails because the other rank does not exist.
    RunOutcome run_as_rank() const {
        return run_raya(
            {"devices"},
            {.variables = {{"OMPI_COMM_WORLD_RANK", "0"}, {"OMPI_COMM_WORLD_SIZE", "2"}, {"RAYA_RANK_TIMEOUT", "1"}},
             .program = program});
    }

    void check_refused(const std::string& text) const {
        for (const RunOutcome& outcome : {run(), run_as_rank()}) {
            INFO(outcome.describe());
            CHECK(outcome.code == 2);
            CHECK_THAT(outcome.err, Contains("refused to load '" + modules.string() + "/raya_"));
            CHECK_THAT(outcome.err, Contains(text));
        }
    }

    fs::path top, program, modules;
};

TEST_CASE("raya loads modules only from its own folder, or from ../lib/raya if it is in bin", "[cli][module]") {
    const ScratchFolder folder;
    CHECK(Installation(folder / "flat", ".", ".").run().code == 0);
    CHECK(Installation(folder / "prefix", "bin", "lib/raya").run().code == 0);
    // Earlier versions searched these folders, in which another user may put files. raya loads no module from them.
    for (const auto& [program, modules] : {std::pair{"sub", "."}, {"sub", "lib/raya"}, {"bin", "bin"}, {"bin", "."}}) {
        CAPTURE(program, modules);
        const ScratchFolder scratch;
        const Installation foreign(scratch / "foreign", program, modules);
        const RunOutcome image_run = foreign.run(), rank_run = foreign.run_as_rank();
        INFO(image_run.describe() + rank_run.describe());
        CHECK(image_run.code == 2);
        CHECK_THAT(image_run.err, Contains("there is no file '") && Contains("/raya_pictures.so'") && Contains(".png"));
        CHECK(rank_run.code == 2);
        CHECK_THAT(rank_run.err, Contains("there is no file '") && Contains("/raya_mpi.so'"));
    }
}

TEST_CASE("modules: refused if other users may write or replace them", "[cli][module]") {
    const ScratchFolder folder;
    const Installation flat(folder / "flat", ".", "."), prefix(folder / "prefix", "bin", "lib/raya");
    const auto check_mode = [](const Installation& installation, const fs::path& path, mode_t mode,
                               const std::string& text) {
        CAPTURE(path, mode);
        struct stat before {};
        REQUIRE(::stat(path.c_str(), &before) == 0);
        ::chmod(path.c_str(), mode);
        installation.check_refused("other users may write '" + text);
        ::chmod(path.c_str(), before.st_mode & 07777);
    };
    check_mode(flat, flat.top, 0777, flat.top.string() + "' (mode 0777)");
    check_mode(flat, flat.top, 01777, flat.top.string() + "' (mode 1777)");
    check_mode(prefix, prefix.modules, 0757, prefix.modules.string() + "' (mode 0757)");
    check_mode(prefix, prefix.top / "lib", 0777, (prefix.top / "lib").string() + "' (mode 0777)");
    ::chmod((prefix.top / "lib").c_str(), 01777);  // sticky bit: other users cannot replace lib/raya
    CHECK(prefix.run().code == 0);
    for (const char* name : {"raya_pictures.so", "raya_mpi.so"}) {
        ::chmod((flat.modules / name).c_str(), 0777);
        ::rename((prefix.modules / name).c_str(), (prefix.top / name).c_str());
        fs::create_symlink(prefix.top / name, prefix.modules / name);
    }
    flat.check_refused("(mode 0777)");
    CHECK_THAT(prefix.run().err, Contains("there is no file '"));
    CHECK_THAT(prefix.run_as_rank().err, Contains("there is no file '"));
}

TEST_CASE("modules: group write permission is accepted only for the owner's own group", "[cli][module]") {
    if (::geteuid() != 0) return;
    const ScratchFolder folder;
    const Installation flat(folder / "flat", ".", ".");
    ::chmod(flat.top.c_str(), 0775);
    CHECK(flat.run().code == 0);  // root's group has no other member
    constexpr gid_t kUnnamedGroup = 54'321;
    REQUIRE(::chown(flat.top.c_str(), 0, kUnnamedGroup) == 0);
    flat.check_refused("(mode 0775)");
    REQUIRE(::chown(flat.top.c_str(), 0, kNobody) == 0);
    flat.check_refused("(mode 0775)");
    REQUIRE(::chown(flat.top.c_str(), 0, 1) == 0);  // group 1 is that of the user daemon
    flat.check_refused("(mode 0775)");
}

TEST_CASE("modules: raya loads modules of the program's owner and of root, and refuses modules of other users",
          "[cli][module]") {
    if (::geteuid() != 0) return;
    const ScratchFolder folder;
    ::chmod(folder.path().c_str(), 0755);
    const Installation prefix(folder / "prefix", "bin", "lib/raya");
    CHECK(prefix.run(true).code == 0);  // files of root, run by another user
    for (const auto& entry : fs::recursive_directory_iterator(prefix.modules))
        REQUIRE(::chown(entry.path().c_str(), kNobody, 0) == 0);
    prefix.check_refused("' belongs to user nobody");
    REQUIRE(::chown(prefix.program.c_str(), kNobody, 0) == 0);  // whoever runs a program trusts its owner
    CHECK(prefix.run().code == 0);
}

/// Runs raya as user nobody, with given folders for the kernel cache.
struct CacheRun {
    ScratchFolder temporary;
    std::vector<std::pair<std::string, std::string>> variables;

    explicit CacheRun(mode_t mode = 01777) { ::chmod(temporary.path().c_str(), mode); }

    RunOutcome operator()(const std::string& home, const std::string& cache = "") const {
        return run_raya({"devices"}, {.variables = {{"POCL_CACHE_DIR", ""},
                                                    {"TMPDIR", temporary.path()},
                                                    {"HOME", home},
                                                    {"XDG_CACHE_HOME", cache}},
                                      .as_nobody = true});
    }

    /// Returns the path of the private cache folder that raya creates in TMPDIR.
    fs::path private_folder() const {
        return temporary / ("raya-pocl-cache-" + std::to_string(::geteuid() == 0 ? kNobody : ::geteuid()));
    }
};

void give_to_nobody(const fs::path& path) {
    if (::geteuid() == 0) REQUIRE(::chown(path.c_str(), kNobody, kNobody) == 0);
}

TEST_CASE("kernel cache: raya uses a private folder if other users may write PoCL's default folder", "[cli][cache]") {
    const CacheRun run;
    const ScratchFolder homes;
    ::chmod(homes.path().c_str(), 0755);
    const auto check_private_folder = [&](const std::string& home, const std::string& cache,
                                          const std::string& reason) {
        CAPTURE(home, cache);
        fs::remove_all(run.private_folder());
        const RunOutcome outcome = run(home, cache);
        INFO(outcome.describe());
        CHECK(outcome.code == 0);
        CHECK_THAT(outcome.err,
                   Contains("raya: warning: ") && Contains(reason) && Contains(run.private_folder().string()));
        struct stat status {};
        REQUIRE(::stat(run.private_folder().c_str(), &status) == 0);
        CHECK(status.st_mode == (S_IFDIR | 0700));
    };
    CHECK_FALSE(fs::exists("/tmp/pocl"));
    check_private_folder("", "", "'/tmp");
    CHECK_FALSE(fs::exists("/tmp/pocl"));
    fs::create_directories(homes / "writable/.cache/pocl");
    give_to_nobody(homes / "writable/.cache/pocl");
    ::chmod((homes / "writable/.cache/pocl").c_str(), 0777);
    check_private_folder(homes / "writable", "", "other users may write");
    check_private_folder(homes / "elsewhere", homes / "writable/.cache", "other users may write");
    fs::create_directories(homes / "above/.cache/pocl/kcache");
    for (const char* name : {"above/.cache/pocl/kcache", "above/.cache/pocl", "above/.cache"})
        give_to_nobody(homes / name);
    ::chmod((homes / "above").c_str(), 0777);
    check_private_folder(homes / "above", "", "/above' (mode 0777)");
    if (::geteuid() != 0) return;  // the folders are this user's
    check_private_folder(homes.path(), "", "is not writable");
    fs::create_directories(homes / "foreign/.cache/pocl");
    REQUIRE(::chown((homes / "foreign/.cache/pocl").c_str(), 1, 1) == 0);
    ::chmod((homes / "foreign/.cache/pocl").c_str(), 0777);
    check_private_folder(homes / "foreign", "", "belongs to user ");
}

TEST_CASE("kernel cache: PoCL's default folder is used if only this user may write it", "[cli][cache]") {
    const CacheRun run;
    const ScratchFolder home;
    ::chmod(home.path().c_str(), 0755);
    give_to_nobody(home.path());
    for (const std::string& cache : {std::string(), (home / "cache").string()}) {
        const RunOutcome outcome = run(home.path(), cache);
        INFO(outcome.describe());
        CHECK(outcome.code == 0);
        CHECK(outcome.err.empty());
        CHECK_FALSE(fs::exists(run.private_folder()));
    }
    CHECK(fs::exists(home / ".cache/pocl/kcache"));
    CHECK(fs::exists(home / "cache/pocl/kcache"));
}

TEST_CASE("kernel cache: without a safe folder, the error names the folder that raya tried", "[cli][cache]") {
    const auto check_none = [](const CacheRun& run) {
        const RunOutcome outcome = run("");
        INFO(outcome.describe());
        CHECK(outcome.code == 3);
        CHECK_THAT(outcome.err, Contains(run.temporary.path().string()) && Contains("name one in POCL_CACHE_DIR") &&
                                    !Contains("no OpenCL device found"));
    };
    check_none(CacheRun(0777));  // without sticky bit: other users can replace the folder
    const CacheRun link, file, foreign, writable;
    fs::create_directory_symlink(link.temporary.path(), link.private_folder());
    check_none(link);
    std::ofstream(file.private_folder()) << "x";
    check_none(file);
    fs::create_directory(foreign.private_folder());
    if (::geteuid() == 0) REQUIRE(::chown(foreign.private_folder().c_str(), 1, 1) == 0);
    ::chmod(foreign.private_folder().c_str(), 0777);
    check_none(foreign);
    fs::create_directory(writable.private_folder());
    give_to_nobody(writable.private_folder());
    ::chmod(writable.private_folder().c_str(), 0757);
    check_none(writable);
}

}  // namespace
}  // namespace raya
