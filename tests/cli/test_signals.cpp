// SIGINT, SIGTERM, SIGHUP and SIGQUIT in every phase of every command: the signal ends the program within a second, and
// the program leaves no incomplete file.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

constexpr double kMaxEndDelay_s = 1;  // from the signal to the end of the program

/// The phase of a command in which it receives the signal.
struct Phase {
    std::string name;
    Arguments arguments;
    std::function<bool()> reached;  // returns true in this phase
    int delay_ms = 0;               // from the first time that `reached` returns true to the signal
    RunOptions run_options{};
};

/// The folders of a test: outputs, inputs and kernel caches.
struct Folders {
    ScratchFolder outputs, inputs, cache;

    std::string fifo(const std::string& name) const {
        ::mkfifo((inputs / name).c_str(), 0600);
        return inputs / name;
    }
};

/// Returns true if the folder or a folder below it has a file whose name contains `part`.
bool has_file(const std::string& folder, const std::string& part) {
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(folder, error))
        if (contains(entry.path().filename().string(), part)) return true;
    return false;
}

/// Sends the signal and checks how the run ends. Repeats a slow run up to twice, because the computer may be loaded.
void check_signal(const Folders& folders, const Phase& phase, int signal) {
    RunOptions run_options = phase.run_options;
    run_options.signal = signal;
    run_options.signal_when = phase.reached;
    run_options.signal_after_ms = phase.delay_ms;
    run_options.signal_count = 2;
    RunOutcome run;
    for (int tries = 0; tries == 0 || (run.after_signal_s > kMaxEndDelay_s && tries < 3); ++tries)
        run = run_raya(phase.arguments, run_options);
    INFO(phase.name + "\n" + run.describe());
    CHECK(run.code == 128 + signal);
    CHECK(run.after_signal_s < kMaxEndDelay_s);
    if (run_options.error_file.empty()) CHECK(run.err.ends_with("raya: interrupted\n"));
    CHECK_FALSE(has_file(folders.outputs.path(), ".tmp"));
    CHECK_FALSE(has_file(folders.inputs.path(), ".tmp"));  // inputs may contain complete files of a study
    CHECK(folders.outputs.entries() == 0);
}

void check_phases(const Folders& folders, const std::vector<Phase>& phases, const std::vector<int>& signals) {
    for (const Phase& phase : phases)
        for (const int signal : signals) check_signal(folders, phase, signal);
}

const std::initializer_list<int> kSignals = {SIGQUIT, SIGINT, SIGTERM, SIGHUP};

/// Returns a phase for every command that reads an input: the command waits for its input.
std::vector<Phase> reading_phases(const Folders& folders) {
    const std::string fifo = folders.fifo("never.nff"), out = folders.outputs / "x.ppm",
                      page = folders.outputs / "x.html";
    std::vector<Phase> phases;
    for (const Arguments& arguments :
         {Arguments{"render", fifo, "-o", out}, Arguments{"bench", fifo}, Arguments{"info", fifo},
          Arguments{"explore", fifo, "-o", page}, Arguments{"page", fifo, "-o", page}})
        phases.push_back({arguments[0] + " reads", arguments, {}, 100});
    return phases;
}

/// Returns the arguments of a long computation: one lane, and at most the 2,000,000 pixels that a page may have.
Arguments long_work(const std::string& command, const Arguments& extra_options) {
    Arguments arguments = {command, scene_file("spheres"), "--size", "1400", "--lanes", "1", "--format", "e8m21"};
    arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
    return arguments;
}

/// Returns a phase for every command that uses a device: the command compiles kernels (`builds` is true) or computes.
std::vector<Phase> computing_phases(const Folders& folders, bool builds) {
    const std::string out = folders.outputs / "x.ppm", cache = folders.cache.path();
    std::vector<Arguments> commands = {long_work("render", {"-o", out, "--machine", "grande"}),
                                       long_work("render", {"-o", out, "--machine", "torus", "--nodes", "2x2x1"}),
                                       long_work("bench", {}),
                                       {"verify", "--full", "--lanes", "1"},
                                       long_work("explore", {"-o", folders.outputs / "x.html"})};
    if (RAYA_STUDIES) commands.push_back({"study", "scale", "-o", folders.inputs / "scale"});
    std::vector<Phase> phases;
    for (const Arguments& arguments : commands) {
        const std::string command_cache = cache + "/" + std::to_string(phases.size());
        fs::create_directories(command_cache);
        const RunOptions run_options{.variables = {{"POCL_CACHE_DIR", command_cache}}};
        if (builds)
            phases.push_back({arguments[0] + " builds", arguments,
                              [command_cache] { return has_file(command_cache, "tempfile"); }, 0, run_options});
        else
            phases.push_back({arguments[0] + " traces", arguments,
                              [command_cache] { return has_file(command_cache, ".so"); }, 1000, run_options});
    }
    return phases;
}

/// Returns a phase for every command that writes a file: the command is blocked in `call`, write() or rename().
std::vector<Phase> writing_phases(const Folders& folders, const std::string& call) {
    const std::string folder = fs::canonical(folders.outputs.path()).string(), output_path = folder + "/x";
    const Arguments small = {scene_file("planes"), "--size", "16", "--lanes", "4", "--format", "fp32"};
    const auto small_command = [&](const std::string& command, const Arguments& extra_options) {
        Arguments arguments = {command};
        if (command != "verify") arguments.insert(arguments.end(), small.begin(), small.end());
        arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
        return arguments;
    };
    const std::string report = folders.inputs / "report.json";
    if (!fs::exists(report)) run_raya(small_command("render", {"-o", folders.inputs / "y.ppm", "--report", report}));
    std::vector<Phase> phases;
    for (const Arguments& arguments :
         {small_command("render", {"-o", output_path + ".ppm"}),
          small_command("render", {"-o", folders.inputs / "y.ppm", "--report", output_path + ".json"}),
          small_command("bench", {"--samples", "1", "--report", output_path + ".json"}),
          Arguments{"verify", "--brief", "--only", "number", "--report", output_path + ".json"},
          small_command("explore", {"-o", output_path + ".html"}),
          Arguments{"page", report, "-o", output_path + ".html"},
          Arguments{"generate", "random", "9", "-o", output_path + ".nff"}})
        phases.push_back({arguments[0] + " in " + call,
                          arguments,
                          [folder] { return has_file(folder, ".tmp"); },
                          20,
                          {.variables = {{"LD_PRELOAD", RAYA_DISK_FAULTS},
                                         {"RAYA_FULL_DISK", call + " " + folder},
                                         {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0"}}}});
    return phases;
}

TEST_CASE("signals: end every command that waits for its input", "[cli][signals]") {
    const Folders folders;
    check_phases(folders, reading_phases(folders), quick(1, kSignals));
}

TEST_CASE("signals: end a render that compiles or traces", "[cli][signals]") {
    const Folders folders;
    for (const bool builds : {true, false}) {
        std::vector<Phase> phases = computing_phases(folders, builds);
        phases.resize(1);
        check_phases(folders, phases, quick(1, kSignals));
    }
}

TEST_CASE("signals: end every command that compiles or computes", "[cli][signals][.][long]") {
    for (const bool builds : {true, false})
        for (const int signal : kSignals) {
            const Folders folders;
            check_phases(folders, computing_phases(folders, builds), {signal});
        }
}

TEST_CASE("signals: leave no part of a file that a command is writing", "[cli][signals]") {
    const Folders folders;
    for (const char* call : {"write", "rename"}) {
        std::vector<Phase> phases = writing_phases(folders, call);
        if (!thorough()) phases.erase(phases.begin() + 1, phases.end() - 3);
        check_phases(folders, phases, quick(1, kSignals));
    }
}

/// A full pipe that no process reads.
class FullPipe {
  public:
    explicit FullPipe(const std::string& path) : pipe_(::open(path.c_str(), O_RDWR | O_NONBLOCK)) {
        const std::string block(4096, 'x');
        while (::write(pipe_, block.data(), block.size()) > 0) continue;
    }
    FullPipe(const FullPipe&) = delete;
    FullPipe& operator=(const FullPipe&) = delete;
    ~FullPipe() { ::close(pipe_); }

  private:
    int pipe_;
};

TEST_CASE("signals: end every command that is blocked on its output", "[cli][signals]") {
    const Folders folders;
    const std::string pipe = folders.fifo("pipe"), planes = scene_file("planes");
    const FullPipe full_pipe(pipe);
    std::vector<Phase> phases;
    for (const Arguments& arguments : {Arguments{"info", planes}, Arguments{"devices"}, Arguments{"help", "render"},
                                       Arguments{"generate", "random", "9", "-o", "-"}}) {
        phases.push_back({arguments[0] + " prints", arguments, {}, 500, {.out_file = pipe}});
        phases.push_back({arguments[0] + " prints", arguments, {}, 500, {.error_file = pipe, .out_file = pipe}});
    }
    if (!thorough()) phases.erase(phases.begin() + 2, phases.end() - 2);
    check_phases(folders, phases, quick(1, kSignals));
}

TEST_CASE("signals: end a command whose driver does not respond", "[cli][signals]") {
    const Folders folders;
    check_phases(folders, {{"devices", {"devices"}, {}, 300, device_with_fault("clGetPlatformIDs 1 slow")}},
                 quick(1, kSignals));
}

}  // namespace
}  // namespace raya
