// Runs of raya under mpirun write the same files as a single process, and print everything once.
#include <fmt/core.h>

#include <map>
#include <set>

#include "host/base/whole_file.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/document.hpp"
#include "tests/ranks/run_ranks.hpp"
#include "tests/report/trace_schema.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

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

RanksOutcome run_on(const Mpi& mpi, std::uint32_t count, const Arguments& render, const RunOptions& options = {}) {
    Arguments arguments = {"-n", std::to_string(count), mpi.program};
    arguments.insert(arguments.end(), render.begin(), render.end());
    return run_ranks(mpi, arguments, 0, {}, options);
}

void check_same_files(const Mpi& mpi, std::uint32_t count, const Arguments& render, const ScratchFolder& folder,
                      const Files& expected, const RunOptions& options = {}) {
    const RanksOutcome run = run_on(mpi, count, render, options);
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK(run.messages == 0);
    CHECK(run.remaining == 0);
    CHECK((files_in(folder) == expected));
}

}  // namespace

TEST_CASE("mpirun: the files of any number of ranks are those of a single process", "[ranks][.mpirun]") {
    const ScratchFolder folder;
    const Arguments common = {"render",   scene_file("spheres"),
                              "-o",       folder / "x.pfm",
                              "--report", folder / "x.json",
                              "--quiet",  "--group",
                              "1",        "--lanes",
                              "4"};
    for (const Arguments& options :
         {Arguments{"--pes", "13", "--antialias", "supersample", "--mask", folder / "m.pfm", "--cost", folder / "c.pfm",
                    "--accel", "bvh", "--from", "3,-6,4", "--light", "5,5,9", "--size", "40x24"},
          Arguments{"--pes", "15", "--split", "5", "--size", "20"},
          Arguments{"--machine", "torus", "--nodes", "3x2x2", "--size", "16"}}) {
        Arguments render = common;
        render.insert(render.end(), options.begin(), options.end());
        REQUIRE(run_raya(render).code == 0);
        const Files expected = files_in(folder);
        CHECK(expected.size() == (options.size() > 10 ? 4 : 2));
        for (const Mpi& mpi : installed_mpis())
            for (const std::uint32_t count : quick(2, {3u, 5u, 8u, 1u, 2u, 4u, 7u}))
                check_same_files(mpi, count, render, folder, expected);
    }
}

TEST_CASE("mpirun: ranks have devices of different types, each with memory for a part of the scene",
          "[ranks][.mpirun]") {
    if (kSanitized) return;
    const ScratchFolder folder, other;
    const std::string scene = other / "u.nff";
    REQUIRE(run_raya({"generate", "uniform", "60000", "--voxels", "4x4x4", "-o", scene}).code == 0);
    const Arguments torus = {"render",      scene,       "--machine", "torus", "--size",        "32", "--queue", "64",
                             "--pe-memory", "100000000", "--quiet",   "-o",    folder / "x.pfm"};
    REQUIRE(run_raya(torus).code == 0);
    const Files expected = files_in(folder);
    // 4112 is CL_DEVICE_MAX_MEM_ALLOC_SIZE. The limit of 1 MB is less than the size of the words of all nodes, 1.4 MB.
    const RunOptions small_devices{.variables = {{"LD_PRELOAD", RAYA_CL_FAULTS},
                                                 {"RAYA_FAULT", "clGetDeviceInfo 4112 1000000"},
                                                 {"POCL_DEVICES", "pthread basic"}}};
    const RunOutcome refused = run_raya(torus, small_devices);
    INFO(refused.describe());
    CHECK(refused.code == 3);
    CHECK(contains(refused.err, "node memories"));
    Arguments on_devices = torus;
    on_devices.insert(on_devices.end(), {"--device", "0,1"});
    for (const Mpi& mpi : installed_mpis()) check_same_files(mpi, 4, on_devices, folder, expected, small_devices);
}

TEST_CASE("mpirun: trace, roofline and report contain every rank", "[ranks][.mpirun]") {
    const ScratchFolder folder;
    for (const Mpi& mpi : installed_mpis())
        for (const std::string& machine : quick<std::string>(1, {"spa", "torus"})) {
            const RanksOutcome run =
                run_on(mpi, 3,
                       {"render", scene_file("spheres"), "--size", "32", "--machine", machine, "-o", folder / "i.pfm",
                        "--trace", folder / "t.json", "--profile", "--report", folder / "r.json"});
            INFO(run.describe());
            REQUIRE(run.code == 0);
            CHECK(contains(run.out, "ranks   3 on 1 host"));
            const Document trace = Document::parse(file_contents(folder / "t.json"));
            CHECK(TraceSchema(trace).faults().empty());
            CHECK(trace["otherData"]["rank_clocks"].size() == 3);
            std::set<std::string> processes;
            for (const Document& event : trace["traceEvents"])
                if (event["name"] == "process_name")
                    processes.insert(event["args"]["name"].get<std::string>().substr(0, 12));
            const Document report = Document::parse(file_contents(folder / "r.json"));
            std::uint64_t messages = 0, rays = 0, expected_rays = 0;
            for (const Document& rank : report["measured"]["ranks"]) {
                const std::string name = "rank " + std::to_string(rank["rank"].get<int>());
                CHECK((processes.contains(name + " host ") && processes.contains(name + " devic")));
                CHECK(contains(run.out, name + " on "));
                messages += rank["messages_sent"].get<std::uint64_t>();
                CHECK(rank["waiting_s"].get<double>() <= rank["render_s"].get<double>());
                for (const Document& row : rank["roofline"])
                    if (row["label"] == (machine == "spa" ? "trace" : "trace_voxel"))
                        rays += row["rays"].get<std::uint64_t>();
            }
            for (const char* kind : {"primary", "reflected", "refracted", "shadow"})
                expected_rays += report["rays"][kind].get<std::uint64_t>();
            CHECK(messages > 0);
            CHECK(rays == expected_rays);
        }
}

TEST_CASE("mpirun: a render that a failing device ends is resumed on any number of ranks", "[ranks][.mpirun]") {
    if (kSanitized) return;
    const ScratchFolder folder;
    const std::string checkpoint = folder / "s.rst";
    const Arguments render = {"render",    scene_file("centre"),
                              "-o",        folder / "x.pfm",
                              "--report",  folder / "x.json",
                              "--quiet",   "--lanes",
                              "4",         "--group",
                              "1",         "--checkpoint",
                              checkpoint,  "--checkpoint-every",
                              "0",         "--resume",
                              "--machine", "torus",
                              "--nodes",   "2x2x2",
                              "--size",    "24"};
    REQUIRE(run_raya(render).code == 0);
    const Files expected = files_in(folder);
    REQUIRE(expected.size() == 2);
    for (const Mpi& mpi : installed_mpis()) {
        for (int launch = 20; launch < 150 && !std::filesystem::exists(checkpoint); launch += 20) {
            const std::string fault =
                fmt::format("export LD_PRELOAD={} RAYA_FAULT='clEnqueueNDRangeKernel {} -5'", RAYA_CL_FAULTS, launch);
            const RanksOutcome failed = run_ranks(mpi, RankScript().arguments(mpi, 3, 1, fault, render));
            INFO(failed.describe());
            CHECK(failed.code == 3);
            CHECK_THAT(failed.err, Catch::Contains("raya: rank 1 on "));
        }
        REQUIRE(std::filesystem::exists(checkpoint));
        const std::string state = file_contents(checkpoint);
        for (const std::uint32_t count : {2u, 1u}) {
            write_whole_file(checkpoint, state);
            check_same_files(mpi, count, render, folder, expected);
        }
        std::filesystem::remove(checkpoint);
    }
}

TEST_CASE("mpirun: only rank 0 reads stdin, writes stdout and prints verbose messages", "[ranks][.mpirun][verbosity]") {
    const ScratchFolder folder;
    const std::string options = " --lanes 4 --pes 8 --size 16 --background 1,0.5,0 ";
    const auto shell = [&](const std::string& line) {
        return std::system(("cd '" + folder.path().string() + "' && " + line).c_str());
    };
    const std::string scene = "'" + scene_file("planes") + "'";
    REQUIRE(shell("'" RAYA_PROGRAM "' render " + scene + " -o single.ppm --quiet" + options) == 0);
    for (const Mpi& mpi : installed_mpis()) {
        const std::string launch = mpi.launcher + " --bind-to none -n 3 '" + mpi.program + "'";
        CAPTURE(launch);
        CHECK(shell(launch + " render - -o - -vv" + options + "< " + scene + " > ranks.ppm 2> messages") == 0);
        CHECK((file_contents(folder / "ranks.ppm") == file_contents(folder / "single.ppm")));
        const std::string messages = file_contents(folder / "messages");
        for (const char* line : {"raya: device ", "raya: read scene: ", "raya: trace: "}) {
            CHECK(contains(messages, line));
            CHECK(messages.find(line) == messages.rfind(line));
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

}  // namespace raya
