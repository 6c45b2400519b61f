// Failures of one rank, and failures of all ranks at the start. raya prints one message, and no output file and no
// process remains. The exit code is not 0. If mpirun forwards the exit code, it is that of a single process.
#include "tests/cli/device_with_fault.hpp"
#include "tests/ranks/run_ranks.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

struct Failure {
    std::string name;
    Arguments options{};    // of a render
    std::string command{};  // of the shell, before one rank runs raya
    int code = 0;           // exit code; 0: any other than 0, because mpirun may not forward it
    Arguments message{};    // parts of the message
    RanksFault signal{};
    std::vector<std::pair<std::string, std::string>> variables{};
    std::size_t max_messages = 1;
    std::uint32_t rank = 1;  // rank that fails
};

bool is_open_mpi_6(const Mpi& mpi) { return contains(run_ranks(mpi, {"--version"}).out, "(Open MPI) 6."); }

void check_ended(const ScratchFolder& outputs, const RanksOutcome& run, std::size_t max_messages) {
    CHECK(run.code != 0);
    CHECK(run.code != RanksOutcome::kKilled);
    CHECK(run.messages <= max_messages);
    CHECK(run.remaining == 0);
    CHECK(outputs.entries() == 0);
}

void check(const ScratchFolder& outputs, const Failure& failure, const RanksOutcome& run) {
    INFO(failure.name << ": " << run.describe());
    check_ended(outputs, run, failure.max_messages);
    if (failure.code != 0) {
        CHECK(run.code == failure.code);
        CHECK(run.messages == 1);
    }
    for (const std::string& part : failure.message) CHECK_THAT(run.err, Catch::Contains(part));
}

void check_failures(const ScratchFolder& outputs, const std::vector<Failure>& failures) {
    for (const Mpi& mpi : installed_mpis())
        for (const Failure& f : failures) {
            Arguments render = {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--quiet", "--lanes", "4"};
            render.insert(render.end(), f.options.begin(), f.options.end());
            const RankScript script;
            check(outputs, f,
                  run_ranks(mpi, script.arguments(mpi, 3, f.rank, f.command, render), f.signal.signal ? 3 : 0, f.signal,
                            {.variables = f.variables}));
        }
}

}  // namespace

TEST_CASE("mpirun: an error of all ranks is reported once, with rank and host", "[ranks][.mpirun]") {
    const ScratchFolder outputs;
    check_failures(outputs,
                   {{"unknown option", {"--pess", "8"}, "", 2, {"raya: rank ", "did you mean --pes?"}},
                    {"no PEs", {"--pes", "0"}, "", 2, {"raya: rank ", "--pes 0"}},
                    {"few PEs", {"--size", "16", "--pes", "2"}, "", 2, {"raya: rank ", "3 ranks for 2 PEs"}},
                    {"few nodes", {"--machine", "torus", "--nodes", "2x1x1"}, "", 2, {"3 ranks for 2 nodes"}},
                    {"no device", {"--device", "nosuch"}, "", 3, {"raya: rank ", "no OpenCL device matches"}},
                    {"other options", {}, "set -- \"$@\" --pes 8", 2, {"raya: rank ", "other arguments than rank 0"}}});
    for (const Mpi& mpi : installed_mpis())
        for (const std::string command : {"devices", "bench"})
            check(outputs, {command, {}, "", 2, {"raya: rank ", command + " runs in one process"}},
                  run_ranks(mpi, {"-n", "2", mpi.program, command}));
}

TEST_CASE("mpirun of another MPI is refused with one message", "[ranks][.mpirun]") {
    const ScratchFolder outputs;
    const std::vector<Mpi> mpis = installed_mpis();
    for (const Mpi& mpi : mpis)
        for (const Mpi& other : mpis)
            if (mpi.launcher != other.launcher)
                check(outputs,
                      {"other MPI", {}, "", 2, {"raya: started as one of 2 ", "remedy: use the mpirun of that MPI"}},
                      run_ranks(mpi,
                                {"-n", "2", other.program, "render", scene_file("planes"), "-o", outputs / "x.pfm"}));
}

TEST_CASE("mpirun: a failing device, driver, memory or disk of one rank ends all ranks", "[ranks][.mpirun]") {
    if (kSanitized) return;
    const ScratchFolder outputs;
    const auto fault = [](const std::string& text) {
        return std::string("export LD_PRELOAD=" RAYA_CL_FAULTS " RAYA_FAULT='") + text + "'";
    };
    const Arguments ring = {"--size", "64", "--pes", "8"}, torus = {"--size", "32", "--machine", "torus"};
    const Arguments large = {"--machine", "grande", "--size", "600"};
    Arguments fills_cache = {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--lanes", "4"};
    fills_cache.insert(fills_cache.end(), large.begin(), large.end());
    REQUIRE(run_raya(fills_cache).code == 0);
    std::filesystem::remove(outputs / "x.pfm");
    for (const std::uint32_t rank : quick(1, {2u, 0u})) {
        const std::string prefix = "raya: rank " + std::to_string(rank) + " on ";
        const Arguments launch_failed = {prefix, "clEnqueueNDRangeKernel failed"};
        std::vector<Failure> failures = {
            {"launch, ring", ring, fault("clEnqueueNDRangeKernel 1 -4"), 3, launch_failed},
            {"launch, torus", torus, fault("clEnqueueNDRangeKernel 20 -4"), 3, launch_failed},
            {"context", ring, fault("clCreateContext 1 -6"), 3, {prefix}},
            {"driver ends the program", ring, fault("clEnqueueNDRangeKernel 1 exit")},
            {"memory", large, fault("new 1000000 0"), 2, {prefix, "out of memory on the host"}},
            {"process ends before MPI_Init", ring, "exit 1", 0, {}, {}, {{"RAYA_RANK_TIMEOUT", "2"}}},
            {"process killed before MPI_Init", ring, "kill -KILL $$", 0, {}, {}, {{"RAYA_RANK_TIMEOUT", "2"}}}};
        // MPICH's mpirun returns another exit code, and interrupts rank 0, which then prints a second message.
        failures.push_back({"driver crashes",
                            ring,
                            fault("clEnqueueNDRangeKernel 1 crash"),
                            0,
                            {prefix, "the OpenCL driver crashed (SIGSEGV)"},
                            {},
                            {},
                            2});
        for (Failure& f : failures) f.rank = rank;
        check_failures(outputs, failures);
    }
    const std::string folder = std::filesystem::canonical(outputs.path()).string();
    check_failures(outputs, {{"full disk",
                              {"--size", "512"},
                              "",
                              2,
                              {"raya: rank 0 on ", "x.pfm", "No space left on device"},
                              {},
                              {{"LD_PRELOAD", RAYA_DISK_FAULTS}, {"RAYA_FULL_DISK", "100000 " + folder}}}});
}

// mpirun may drop the output of an interrupted rank, so this test redirects rank 0's messages to a file. By default
// Open MPI kills a rank one second after a signal, which is too early on a busy machine; in this test it waits 4 s.
// Open MPI 6.0.0rc2 kills the ranks within 0.1 s.
TEST_CASE("mpirun: a killed or hanging rank, SIGINT and SIGTERM end all ranks", "[ranks][.mpirun]") {
    const ScratchFolder outputs, messages;
    const std::string file = messages / "rank_0.txt";
    const Arguments ring = {"--machine", "grande", "--size", "8000"}, torus = {"--machine", "torus", "--size", "2000"};
    check_failures(outputs, {{"killed", ring, "", 0, {}, {.signal = SIGKILL, .rank = 2}},
                             {"killed", torus, "", 0, {}, {.signal = SIGKILL, .rank = 2}},
                             {"hangs",
                              torus,
                              "",
                              3,
                              {"has waited for the other ranks for 6 s", "RAYA_RANK_TIMEOUT"},
                              {.signal = SIGSTOP, .rank = 2},
                              {{"RAYA_RANK_TIMEOUT", "6"}}}});
    for (const int signal : quick(1, {SIGINT, SIGTERM})) {
        check_failures(outputs, {{.name = "interrupted",
                                  .options = ring,
                                  .command = "exec 2>" + file,
                                  .signal = {.signal = signal},
                                  .variables = {{"OMPI_MCA_odls_base_sigkill_timeout", "4"}},
                                  .max_messages = 0,
                                  .rank = 0}});
        for (const Mpi& mpi : installed_mpis())
            if (!is_open_mpi_6(mpi)) CHECK_THAT(file_contents(file), Catch::EndsWith("raya: interrupted\n"));
    }
}

}  // namespace raya
