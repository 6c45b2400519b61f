// Renders under mpirun: ranks with devices of different types, a scene too large for the memory of one device, and the
// traces and reports of several ranks.
#include <catch2/catch.hpp>
#include <set>

#include "host/base/child_process.hpp"
#include "tests/document.hpp"
#include "tests/ranks/run_ranks.hpp"
#include "tests/report/trace_schema.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

std::string hash_of(const std::filesystem::path& report) {
    return Document::parse(file_contents(report))["image"]["hash"];
}

}  // namespace

TEST_CASE("ranks with devices of different types give the image of a single process", "[ranks][.mpirun]") {
    const TemporaryFolder folder("raya-ranks");
    const std::filesystem::path single_report = folder.path() / "single.json",
                                ranks_report = folder.path() / "ranks.json";
    const std::string image = folder.path() / "i.pfm";
    const std::vector<std::string> render = {"render", scene_file("glass"), "--size", "48", "--antialias",
                                             "filter", "--quiet",           "-o",     image};
    std::vector<std::string> single_run = render;
    single_run.insert(single_run.end(), {"--report", single_report});
    REQUIRE(run_raya(single_run).code == 0);
    for (const Mpi& mpi : installed_mpis()) {
        std::vector<std::string> arguments = {"-n", "3", mpi.program};
        arguments.insert(arguments.end(), render.begin(), render.end());
        arguments.insert(arguments.end(), {"--report", ranks_report, "--device", "0,1"});
        const RanksOutcome outcome =
            run_ranks(mpi, arguments, 0, {}, {.variables = {{"POCL_DEVICES", "pthread basic"}}});
        INFO(outcome.describe());
        REQUIRE(outcome.code == 0);
        CHECK(hash_of(ranks_report) == hash_of(single_report));
        std::vector<std::string> devices;
        const Document report = Document::parse(file_contents(ranks_report));
        for (const Document& rank : report["measured"]["ranks"])
            devices.push_back(rank["device"]["name"].get<std::string>());
        REQUIRE(devices.size() == 3);
        CHECK(devices[0] != devices[1]);
        CHECK(devices[2] == devices[0]);
    }
}

TEST_CASE("a torus scene too large for one device is rendered on several ranks", "[ranks][.mpirun]") {
    const TemporaryFolder folder("raya-ranks");
    const std::string scene = folder.path() / "u.nff", image = folder.path() / "i.pfm";
    const std::filesystem::path single_report = folder.path() / "single.json",
                                ranks_report = folder.path() / "ranks.json";
    REQUIRE(run_raya({"generate", "uniform", "60000", "--voxels", "4x4x4", "-o", scene}).code == 0);
    REQUIRE(run_raya({"render", scene, "--machine", "grande", "--accel", "bvh", "--size", "32", "--quiet", "-o", image,
                      "--report", single_report})
                .code == 0);
    const std::vector<std::string> torus = {"render",  scene,     "--machine", "torus",       "--size",
                                            "32",      "--queue", "64",        "--pe-memory", "100000000",
                                            "--quiet", "-o",      image,       "--report",    ranks_report};
    // 4112 is CL_DEVICE_MAX_MEM_ALLOC_SIZE. The limit of 1 MB is less than the size of the words of all nodes, 1.4 MB.
    const RunOptions small_device{
        .variables = {{"LD_PRELOAD", RAYA_CL_FAULTS}, {"RAYA_FAULT", "clGetDeviceInfo 4112 1000000"}}};
    const RunOutcome refused = run_raya(torus, small_device);
    INFO(refused.describe());
    CHECK(refused.code == 3);
    CHECK(contains(refused.err, "node memories"));
    for (const Mpi& mpi : installed_mpis()) {
        std::vector<std::string> arguments = {"-n",
                                              "4",
                                              "env",
                                              small_device.variables[0].first + "=" + small_device.variables[0].second,
                                              small_device.variables[1].first + "=" + small_device.variables[1].second,
                                              mpi.program};
        arguments.insert(arguments.end(), torus.begin(), torus.end());
        const RanksOutcome outcome = run_ranks(mpi, arguments);
        INFO(outcome.describe());
        REQUIRE(outcome.code == 0);
        CHECK(hash_of(ranks_report) == hash_of(single_report));
    }
}

TEST_CASE("a trace contains the host and the device of every rank, on one clock", "[ranks][.mpirun]") {
    const TemporaryFolder folder("raya-ranks");
    const std::filesystem::path trace = folder.path() / "t.json", report = folder.path() / "r.json";
    for (const Mpi& mpi : installed_mpis())
        for (const char* machine : {"spa", "torus"}) {
            const RanksOutcome outcome =
                run_ranks(mpi, {"-n", "3", mpi.program, "render", scene_file("spheres"), "--size", "32", "--machine",
                                machine, "-o", folder.path() / "i.pfm", "--trace", trace, "--report", report});
            INFO(outcome.describe());
            REQUIRE(outcome.code == 0);
            CHECK(contains(outcome.out, "ranks   3 on 1 host"));
            const Document file = Document::parse(file_contents(trace));
            CHECK(TraceSchema(file).faults().empty());
            CHECK(file["otherData"]["rank_clocks"].size() == 3);
            std::set<std::string> names;
            for (const Document& event : file["traceEvents"])
                if (event["name"] == "process_name")
                    names.insert(event["args"]["name"].get<std::string>().substr(0, 12));
            for (const char* name :
                 {"rank 0 host ", "rank 1 host ", "rank 2 host ", "rank 0 devic", "rank 1 devic", "rank 2 devic"})
                CHECK(names.count(name) == 1);
            std::uint64_t messages = 0;
            const Document contents = Document::parse(file_contents(report));
            for (const Document& rank : contents["measured"]["ranks"]) {
                messages += rank["messages_sent"].get<std::uint64_t>();
                CHECK(rank["waiting_s"].get<double>() <= rank["render_s"].get<double>());
                CHECK(!rank["commands"].empty());
            }
            CHECK(messages > 0);
        }
}

TEST_CASE("--profile on several ranks has the roofline of every rank", "[ranks][.mpirun]") {
    const TemporaryFolder folder("raya-ranks");
    const std::filesystem::path report = folder.path() / "r.json";
    for (const Mpi& mpi : installed_mpis())
        for (const char* machine : quick(1, {"spa", "torus"})) {
            CAPTURE(machine);
            const RanksOutcome run =
                run_ranks(mpi, {"-n", "2", mpi.program, "render", scene_file("spheres"), "--size", "32", "--machine",
                                machine, "-o", folder.path() / "i.pfm", "--profile", "--report", report, "--quiet"});
            INFO(run.describe());
            REQUIRE(run.code == 0);
            const Document contents = Document::parse(file_contents(report));
            const std::string kernel = machine == std::string("spa") ? "trace" : "trace_voxel";
            std::uint64_t rays = 0;
            for (const Document& rank : contents["measured"]["ranks"]) {
                CHECK(rank["peak"]["fp32_multiply_adds_per_s"] > 0);
                const auto row = std::find_if(rank["roofline"].begin(), rank["roofline"].end(),
                                              [&](const Document& r) { return r["label"] == kernel; });
                REQUIRE(row != rank["roofline"].end());
                rays += (*row)["rays"].get<std::uint64_t>();
                CHECK(run.out.find("rank " + std::to_string(rank["rank"].get<int>()) + " on ") != std::string::npos);
            }
            const Document& counted = contents["rays"];
            std::uint64_t expected = 0;
            for (const char* kind : {"primary", "reflected", "refracted", "shadow"})
                expected += counted[kind].get<std::uint64_t>();
            CHECK(rays == expected);
            CHECK(contents["measured"]["roofline"] == contents["measured"]["ranks"][0]["roofline"]);
        }
}

}  // namespace raya
