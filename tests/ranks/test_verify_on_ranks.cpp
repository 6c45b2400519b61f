// raya verify under mpirun: the report names the rank, the host and the device of every failure, and a failure on one
// rank does not end the checks of the others.
#include "tests/cli/device_with_fault.hpp"
#include "tests/document.hpp"
#include "tests/ranks/rank_script.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

/// Files of a run of `raya verify` on three ranks, and its arguments.
struct VerifyOnRanks {
    explicit VerifyOnRanks(Arguments options = {"--only", "machine"}) {
        arguments = {"verify",         "--brief", "--report",       folder / "v.json", "--junit",
                     folder / "v.xml", "--tap",   folder / "v.tap", "--page",          folder / "v.html"};
        arguments.insert(arguments.end(), options.begin(), options.end());
    }

    /// Runs with a fault on one rank: `command` is a shell command.
    RanksOutcome run(const Mpi& mpi, std::uint32_t rank = 0, const std::string& command = "true",
                     const RunOptions& run_options = {}) const {
        return run_ranks(mpi, script.arguments(mpi, 3, rank, command, arguments), 0, {}, run_options);
    }

    std::vector<Document> devices() const {
        const Document report = Document::parse(file_contents(folder / "v.json"));
        return {report["devices"].begin(), report["devices"].end()};
    }

    ScratchFolder folder{};
    RankScript script{};
    Arguments arguments{};
};

std::string host_name() {
    std::array<char, 256> name{};
    ::gethostname(name.data(), name.size() - 1);
    return name.data();
}

std::string place_of(std::uint32_t rank) { return "rank " + std::to_string(rank) + " on " + host_name(); }

std::string cl_fault(const std::string& fault) { return preload_command(RAYA_CL_FAULTS, "RAYA_FAULT", fault); }

/// Checks that only `rank` failed: exit code, output and all reports. Returns the device of the rank in the report.
Document check_only_failure(const VerifyOnRanks& verify, const RanksOutcome& run, std::uint32_t rank) {
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK(run.messages == 0);
    CHECK(run.remaining == 0);
    CHECK_THAT(run.out, Catch::Contains("\n3 devices: "));
    const std::vector<Document> devices = verify.devices();
    REQUIRE(devices.size() == 3);
    const std::string xml = file_contents(verify.folder / "v.xml"), page = file_contents(verify.folder / "v.html");
    for (std::uint32_t other = 0; other < 3; ++other) {
        CAPTURE(rank, other);
        const Document& device = devices[other];
        CHECK(device["rank"] == other);
        CHECK(device["host"] == host_name());
        CHECK(device["right"] == (other != rank));
        CHECK((run.out.find(place_of(other) + ": FAIL ") != std::string::npos) == (other == rank));
        CHECK_THAT(xml, Catch::Contains("<testsuite name=\"" + place_of(other) + ": ") &&
                            Catch::Contains("hostname=\"" + host_name() + "\""));
    }
    const std::string tap = file_contents(verify.folder / "v.tap");
    std::istringstream lines(tap);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("not ok ")) CHECK_THAT(line, Catch::Contains(" on " + place_of(rank) + ": "));
    CHECK_THAT(tap, Catch::Contains("\nnot ok "));
    CHECK((page.find("\"host\": \"" + host_name() + "\"") != std::string::npos));
    return devices[rank];
}

}  // namespace

TEST_CASE("mpirun verify: rank 0 reports the devices of all ranks", "[ranks][.mpirun]") {
    const VerifyOnRanks verify;
    for (const Mpi& mpi : installed_mpis()) {
        const RanksOutcome run = verify.run(mpi);
        INFO(run.describe());
        CHECK(run.code == 0);
        CHECK(run.messages == 0);
        CHECK(run.remaining == 0);
        const std::vector<Document> devices = verify.devices();
        REQUIRE(devices.size() == 3);
        for (std::uint32_t rank = 0; rank < 3; ++rank) {
            CHECK(devices[rank]["rank"] == rank);
            CHECK(devices[rank]["right"] == true);
            CHECK(devices[rank]["checks"].size() == devices[0]["checks"].size());
            CHECK_THAT(run.out, Catch::Contains(place_of(rank) + ": " + devices[rank]["name"].get<std::string>()));
        }
        CHECK_THAT(run.out, !Catch::Contains("PASS"));
    }
}

TEST_CASE("mpirun verify: wrong copies, a crash and a hang of one rank's driver are reported with rank and host",
          "[ranks][.mpirun]") {
    if (kSanitized) return;
    const VerifyOnRanks rings({"--only", "machine ring"}), copies({"--only", "machine copies"}),
        mapping({"--only", "machine mapping: rows", "--timeout", "1"});
    for (const Mpi& mpi : installed_mpis())
        for (const std::uint32_t rank : quick(1, {2u, 0u})) {
            const Document wrong =
                check_only_failure(rings, rings.run(mpi, rank, cl_fault("clEnqueueCopyBuffer 1 lost")), rank);
            CHECK(wrong["failed"] == wrong["checks"].size());
            const Document crashed =
                check_only_failure(copies, copies.run(mpi, rank, cl_fault("clEnqueueCopyBufferRect 1 crash")), rank);
            CHECK(crashed["checks"][0]["result"] == "ended by signal 11 (SIGSEGV)");
            const Document hung =
                check_only_failure(mapping, mapping.run(mpi, rank, cl_fault("clFinish 1 slow")), rank);
            CHECK_THAT(hung["checks"][0]["result"].get<std::string>(), Catch::Contains("no result after"));
        }
}

TEST_CASE("mpirun verify: a rank without a device, and ranks that share a GPU, are failures", "[ranks][.mpirun]") {
    if (kSanitized) return;
    const VerifyOnRanks verify({"--only", "machine ring"});
    for (const Mpi& mpi : installed_mpis()) {
        const Document missing = check_only_failure(verify, verify.run(mpi, 1, "export OCL_ICD_VENDORS=/none"), 1);
        CHECK(missing["name"] == "no device");
        CHECK(missing["checks"][0]["layer"] == "device");
        CHECK_THAT(missing["checks"][0]["result"].get<std::string>(), Catch::Contains("no OpenCL device found"));
        // The query of the PCI address returns 003b:00:00.0 on all ranks.
        const RunOptions same_address{
            .variables = {{"LD_PRELOAD", RAYA_CL_FAULTS}, {"RAYA_FAULT", "clGetDeviceInfo 16655 59"}}};
        const RanksOutcome run = run_ranks(mpi, launch_arguments(mpi, 2, verify.arguments), 0, {}, same_address);
        INFO(run.describe());
        CHECK(run.code == 4);
        CHECK_THAT(run.out, Catch::Contains(place_of(1) + ": FAIL  device    of this rank only") &&
                                Catch::Contains("rank 0 has checked the same device") &&
                                Catch::Contains(", PCI 003b:00:00.0: "));
        const std::vector<Document> devices = verify.devices();
        CHECK(devices[0]["right"] == true);
        CHECK(devices[1]["right"] == false);
        CHECK(devices[1]["pci_address"] == "003b:00:00.0");
    }
}

TEST_CASE("mpirun verify: a rank may check for longer than RAYA_RANK_TIMEOUT", "[ranks][.mpirun]") {
    const VerifyOnRanks verify({"--only", "machine mapping: rows"});
    for (const Mpi& mpi : installed_mpis()) {
        const RanksOutcome run =
            verify.run(mpi, 1, cl_fault("clFinish 1 slow"), {.variables = {{"RAYA_RANK_TIMEOUT", "5"}}});
        INFO(run.describe());
        CHECK(run.code == 0);
        CHECK(verify.devices()[1]["seconds"] > 5);
    }
}

TEST_CASE("mpirun verify: a killed rank ends all ranks and their child processes", "[ranks][.mpirun]") {
    const Arguments verify = {"verify", "--soak", "60s", "--brief", "--only", "machine"};
    for (const Mpi& mpi : installed_mpis())
        for (const std::uint32_t rank : quick(1, {2u, 0u})) {
            const RanksOutcome run =
                run_ranks(mpi, launch_arguments(mpi, 3, verify), 3, {.signal = SIGKILL, .rank = rank});
            INFO(run.describe());
            CHECK(run.code != 0);
            CHECK(run.remaining == 0);
            CHECK(run.code != RanksOutcome::kKilled);
        }
}

TEST_CASE("mpirun verify: options that no rank accepts are refused once", "[ranks][.mpirun]") {
    const std::pair<Arguments, std::string> cases[] = {
        {{"--device", "all"}, "--device all, --reproduce, --bisect: start raya without mpirun"},
        {{"--reproduce", "folder"}, "--device all, --reproduce, --bisect: start raya without mpirun"},
        {{"--bisect", "number"}, "--device all, --reproduce, --bisect: start raya without mpirun"},
        {{"--only", "no such check"}, "no check of"}};
    for (const Mpi& mpi : installed_mpis())
        for (const auto& [options, message] : cases) {
            const VerifyOnRanks verify(options);
            const RanksOutcome run = verify.run(mpi);
            INFO(run.describe());
            CHECK(run.code == 2);
            CHECK(run.messages == 1);
            CHECK_THAT(run.err, Catch::Contains("raya: rank ") && Catch::Contains(message));
            CHECK(verify.folder.entries() == 0);
        }
}

}  // namespace raya
