// Runs of raya under mpirun write the same files as a single process.
#include <map>

#include "host/base/whole_file.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/ranks/rank_script.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kRankCounts[] = {1, 2, 3, 4, 7, 8};

/// Contents of a render's files, by file name. Reports omit the measured values.
using Files = std::map<std::string, std::string>;

Files files_in(const ScratchFolder& folder) {
    Files files;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        const std::string name = entry.path().filename();
        files[name] = file_contents(entry.path());
        if (name.ends_with(".json")) {
            Document report = Document::parse(files[name]);
            report.erase("measured");
            files[name] = report.dump(1);
        }
        std::filesystem::remove(entry.path());
    }
    return files;
}

void check_all_rank_counts(const ScratchFolder& folder, const Arguments& render) {
    const RunOutcome single_run = run_raya(render);
    INFO(single_run.describe());
    REQUIRE(single_run.code == 0);
    const Files single_files = files_in(folder);
    for (const Mpi& mpi : installed_mpis())
        for (const std::uint32_t count : kRankCounts) {
            Arguments arguments = {"-n", std::to_string(count), mpi.program};
            arguments.insert(arguments.end(), render.begin(), render.end());
            const RanksOutcome run = run_ranks(mpi, arguments);
            INFO(run.describe());
            REQUIRE(run.code == 0);
            CHECK(run.messages == 0);
            CHECK(run.remaining == 0);
            const Files rank_files = files_in(folder);
            REQUIRE(rank_files.size() == single_files.size());
            for (const auto& [name, bytes] : single_files) {
                CAPTURE(name);
                CHECK((rank_files.at(name) == bytes));
            }
        }
}

TEST_CASE("mpirun: images, counts and loads of the ring are those of a single process", "[ranks][.mpirun]") {
    const ScratchFolder folder;
    const Arguments common = {"render",   scene_file("centre"), "-o",      folder / "x.pfm", "--cost", folder / "c.pfm",
                              "--report", folder / "x.json",    "--quiet", "--lanes",        "4",      "--size",
                              "40x24"};
    for (const Arguments& options :
         {Arguments{"--pes", "8", "--accel", "bvh", "--from", "3,-6,4", "--light", "5,5,9"},
          Arguments{"--pes", "13", "--antialias", "supersample", "--mask", folder / "m.pfm"}}) {
        Arguments render = common;
        render.insert(render.end(), options.begin(), options.end());
        check_all_rank_counts(folder, render);
    }
}

TEST_CASE("mpirun: image, counts, loads and packets of the torus are those of a single process", "[ranks][.mpirun]") {
    const ScratchFolder folder;
    check_all_rank_counts(folder, {"render", scene_file("spheres"), "-o", folder / "x.pfm", "--report",
                                   folder / "x.json", "--packets", folder / "p.csv.gz", "--machine", "torus", "--nodes",
                                   "3x2x2", "--size", "16", "--group", "1", "--quiet"});
}

// Renders on three ranks and saves checkpoints until the device of rank 1 fails. Returns the last checkpoint.
std::string failed_render(const Mpi& mpi, const RankScript& script, const Arguments& render, const std::string& file) {
    for (int launch = 10; launch < 1000; launch += launch / 2) {
        const std::string fault = "clEnqueueNDRangeKernel " + std::to_string(launch) + " -5";
        const RanksOutcome run =
            run_ranks(mpi, script.arguments(mpi, 3, 1, preload_command(RAYA_CL_FAULTS, "RAYA_FAULT", fault), render));
        INFO(run.describe());
        CHECK(run.remaining == 0);
        CHECK_THAT(run.err, Catch::Contains("raya: rank 1 on "));
        if (run.code == 3 && std::filesystem::exists(file)) return file_contents(file);
    }
    throw std::runtime_error("no failed render left a checkpoint");
}

TEST_CASE("mpirun: a render that a failing device ends is resumed on any number of ranks", "[ranks][.mpirun]") {
    if (kSanitized) return;
    const ScratchFolder folder;
    const RankScript script;
    const std::string checkpoint = folder / "s.rst";
    const Arguments common = {"render",   scene_file("centre"),
                              "-o",       folder / "x.pfm",
                              "--report", folder / "x.json",
                              "--quiet",  "--lanes",
                              "4",        "--group",
                              "1",        "--checkpoint",
                              checkpoint, "--checkpoint-every",
                              "0",        "--resume"};
    for (const Arguments& options :
         {Arguments{"--machine", "grande", "--pes", "7", "--antialias", "supersample", "--size", "160x120"},
          Arguments{"--machine", "torus", "--nodes", "2x2x2", "--size", "24"}}) {
        Arguments render = common;
        render.insert(render.end(), options.begin(), options.end());
        REQUIRE(run_raya(render).code == 0);
        const Files expected = files_in(folder);
        REQUIRE(expected.size() == 2);
        for (const Mpi& mpi : installed_mpis()) {
            const std::string state = failed_render(mpi, script, render, checkpoint);
            for (const std::uint32_t count : quick(2, {2u, 1u, 4u})) {
                write_whole_file(checkpoint, state);
                const RanksOutcome run = run_ranks(mpi, launch_arguments(mpi, count, render));
                INFO(run.describe());
                CHECK(run.code == 0);
                CHECK(Document::parse(file_contents(folder / "x.json"))["measured"]["earlier_s"] > 0);
                CHECK((files_in(folder) == expected));
            }
            std::string damaged = state;
            damaged[state.size() / 2] ^= 1;
            write_whole_file(checkpoint, damaged);
            const RanksOutcome run = run_ranks(mpi, launch_arguments(mpi, 2, render));
            INFO(run.describe());
            CHECK(run.code == 2);
            CHECK(run.messages == 1);
            CHECK_THAT(run.err, Catch::Contains("raya: rank 0 on ") &&
                                    Catch::Contains("--resume: " + checkpoint + ": damaged; remove the file"));
            CHECK(file_contents(checkpoint) == damaged);
            std::filesystem::remove(checkpoint);
        }
    }
}

TEST_CASE("mpirun: only rank 0 reads stdin and writes stdout", "[ranks][.mpirun]") {
    const ScratchFolder folder;
    const std::string options = " --quiet --lanes 4 --pes 8 --size 16 --background 1,0.5,0 ";
    const auto shell = [&](const std::string& line) {
        return std::system(("cd '" + folder.path().string() + "' && " + line).c_str());
    };
    const std::string scene = "'" + scene_file("planes") + "'";
    REQUIRE(shell("'" RAYA_PROGRAM "' render " + scene + " -o single.ppm" + options) == 0);
    for (const Mpi& mpi : installed_mpis()) {
        const std::string launch = mpi.launcher + " --bind-to none -n 3 '" + mpi.program + "'";
        CAPTURE(launch);
        CHECK(shell(launch + " render - -o -" + options + "< " + scene + " > ranks.ppm") == 0);
        CHECK((file_contents(folder / "ranks.ppm") == file_contents(folder / "single.ppm")));
    }
}

TEST_CASE("mpirun: only rank 0 prints verbose messages", "[ranks][.mpirun][verbosity]") {
    const ScratchFolder folder;
    for (const Mpi& mpi : installed_mpis()) {
        const RanksOutcome run =
            run_ranks(mpi, {"-n", "3", mpi.program, "render", scene_file("planes"), "-o", folder / "x.pfm", "--size",
                            "16", "--lanes", "4", "--pes", "8", "-vv"});
        INFO(run.describe());
        CHECK(run.code == 0);
        for (const char* line :
             {"raya: device ", "raya: read scene: ", "raya: trace: ", "raya: on the device: trace (kernel)"}) {
            const std::size_t first = run.err.find(line);
            CHECK(first != std::string::npos);
            CHECK(run.err.find(line, first + 1) == std::string::npos);
        }
    }
}

TEST_CASE("mpirun: point-to-point and collective messages of any size arrive unchanged", "[ranks][.mpirun]") {
    for (const Mpi& mpi : installed_mpis())
        for (const std::uint32_t count : {2u, 3u, 7u}) {
            const RanksOutcome run = run_ranks(mpi, {"-n", std::to_string(count), RAYA_TRANSPORT_CHECK, mpi.program});
            INFO(run.describe());
            CHECK(run.code == 0);
            CHECK_THAT(run.out,
                       Catch::Contains(" on " + std::to_string(count) + " ranks") && Catch::Contains(", 0 wrong\n"));
            CHECK(run.remaining == 0);
        }
}

}  // namespace
}  // namespace raya
