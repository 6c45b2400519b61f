// SIGINT, SIGTERM, SIGHUP and SIGQUIT in every phase of every command: the program dies by that signal within a second
// and leaves no file that is not whole.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "tests/cli/failing_device.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

constexpr double kLimit_s = 1;

/// Where a command is when the signal comes.
struct Phase {
    std::string name;
    Words words;
    std::function<bool()> reached;
    int more_ms = 0;  // after that
    Surroundings around{};
};

/// Files of one phase: what is read and where the command writes.
struct Folders {
    ScratchFolder outputs, inputs, cache;

    std::string fifo(const std::string& name) const {
        ::mkfifo((inputs / name).c_str(), 0600);
        return inputs / name;
    }
};

/// Whether a file is below the folder whose name has this text.
bool has_file(const std::string& folder, const std::string& part) {
    std::error_code gone;
    for (const auto& entry : fs::recursive_directory_iterator(folder, gone))
        if (contains(entry.path().filename().string(), part)) return true;
    return false;
}

/// A run on a loaded machine may take longer: the best of three counts.
void check_signal(const Folders& folders, const Phase& phase, int signal) {
    Surroundings around = phase.around;
    around.signal = signal;
    around.signal_when = phase.reached;
    around.signal_after_ms = phase.more_ms;
    around.signal_count = 2;
    RunOutcome run;
    for (int tries = 0; tries == 0 || (run.after_signal_s > kLimit_s && tries < 3); ++tries)
        run = run_raya(phase.words, around);
    INFO(phase.name + "\n" + run.told());
    CHECK(run.code == 128 + signal);
    CHECK(run.after_signal_s < kLimit_s);
    if (around.error_file.empty()) CHECK(run.err.ends_with("raya: interrupted\n"));
    CHECK_FALSE(has_file(folders.outputs.path(), ".tmp"));
    CHECK_FALSE(has_file(folders.inputs.path(), ".tmp"));  // a study's folder, where some files are whole already
    if (phase.words[0] != "manual") CHECK(folders.outputs.entries() == 0);
}

void check_phases(const Folders& folders, const std::vector<Phase>& phases, const std::vector<int>& signals) {
    for (const Phase& phase : phases)
        for (const int signal : signals) check_signal(folders, phase, signal);
}

const std::initializer_list<int> kSignals = {SIGQUIT, SIGINT, SIGTERM, SIGHUP};

std::vector<Phase> reading(const Folders& folders) {
    const std::string fifo = folders.fifo("never.nff"), out = folders.outputs / "x.ppm",
                      page = folders.outputs / "x.html";
    std::vector<Phase> phases;
    for (const Words& words : {Words{"render", fifo, "-o", out}, Words{"bench", fifo}, Words{"info", fifo},
                               Words{"explore", fifo, "-o", page}, Words{"page", fifo, "-o", page}})
        phases.push_back({words[0] + " reads", words, {}, 100});
    return phases;
}

/// Long work, by one lane; a page has 2,000,000 pixels at most.
Words long_work(const std::string& command, const Words& more) {
    Words words = {command, scene_file("spheres"), "--size", "1400", "--lanes", "1", "--format", "e8m21"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// Every command that takes a device, while it compiles and while it computes.
std::vector<Phase> computing(const Folders& folders, bool builds) {
    const std::string out = folders.outputs / "x.ppm", cache = folders.cache.path();
    std::vector<Words> calls = {long_work("render", {"-o", out, "--machine", "grande"}),
                                long_work("render", {"-o", out, "--machine", "torus", "--nodes", "2x2x1"}),
                                long_work("bench", {}),
                                {"verify", "--full", "--lanes", "1"},
                                long_work("explore", {"-o", folders.outputs / "x.html"})};
    if (RAYA_STUDIES) calls.push_back({"study", "scale", "-o", folders.inputs / "scale"});
    std::vector<Phase> phases;
    for (const Words& words : calls) {
        const std::string own = cache + "/" + std::to_string(phases.size());
        fs::create_directories(own);
        const Surroundings around{.variables = {{"POCL_CACHE_DIR", own}}};
        if (builds)
            phases.push_back({words[0] + " builds", words, [own] { return has_file(own, "tempfile"); }, 0, around});
        else
            phases.push_back({words[0] + " traces", words, [own] { return has_file(own, ".so"); }, 1000, around});
    }
    return phases;
}

/// Every command that writes a file, in the middle of it and before it gets its name.
std::vector<Phase> writing(const Folders& folders, const std::string& call) {
    const std::string folder = fs::canonical(folders.outputs.path()).string(), x = folder + "/x";
    const Words small = {scene_file("planes"), "--size", "16", "--lanes", "4", "--format", "fp32"};
    const auto with = [&](const std::string& command, const Words& more) {
        Words words = {command};
        if (command != "verify") words.insert(words.end(), small.begin(), small.end());
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const std::string report = folders.inputs / "report.json";
    if (!fs::exists(report)) run_raya(with("render", {"-o", folders.inputs / "y.ppm", "--report", report}));
    std::vector<Phase> phases;
    for (const Words& words :
         {with("render", {"-o", x + ".ppm"}), with("render", {"-o", folders.inputs / "y.ppm", "--report", x + ".json"}),
          with("bench", {"--samples", "1", "--report", x + ".json"}),
          Words{"verify", "--brief", "--only", "number", "--report", x + ".json"}, with("explore", {"-o", x + ".html"}),
          Words{"page", report, "-o", x + ".html"}, Words{"generate", "random", "9", "-o", x + ".nff"},
          Words{"manual", "-o", folder}, Words{"completion", "bash", "-o", x}})
        phases.push_back({words[0] + " in " + call,
                          words,
                          [folder] { return has_file(folder, ".tmp"); },
                          20,
                          {.variables = {{"LD_PRELOAD", RAYA_DISK_FAULTS},
                                         {"RAYA_FULL_DISK", call + " " + folder},
                                         {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0"}}}});
    return phases;
}

TEST_CASE("a signal ends every command that waits for its input", "[cli][signals]") {
    const Folders folders;
    check_phases(folders, reading(folders), quick(1, kSignals));
}

TEST_CASE("a signal ends a render that compiles or traces", "[cli][signals]") {
    const Folders folders;
    for (const bool builds : {true, false}) {
        std::vector<Phase> phases = computing(folders, builds);
        phases.resize(1);
        check_phases(folders, phases, quick(1, kSignals));
    }
}

TEST_CASE("a signal ends every command that compiles or computes", "[cli][signals][.][long]") {
    for (const bool builds : {true, false})
        for (const int signal : kSignals) {
            const Folders folders;
            check_phases(folders, computing(folders, builds), {signal});
        }
}

TEST_CASE("a signal in the middle of a write leaves nothing of the file", "[cli][signals]") {
    const Folders folders;
    for (const char* call : {"write", "rename"}) {
        std::vector<Phase> phases = writing(folders, call);
        if (!thorough()) phases.erase(phases.begin() + 1, phases.end() - 3);
        check_phases(folders, phases, quick(1, kSignals));
    }
}

/// A pipe that is full and that nobody reads.
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

TEST_CASE("a signal ends every command that nobody listens to", "[cli][signals]") {
    const Folders folders;
    const std::string pipe = folders.fifo("pipe"), planes = scene_file("planes");
    const FullPipe full(pipe);
    std::vector<Phase> phases;
    for (const Words& words : {Words{"info", planes}, Words{"devices"}, Words{"help", "render"}, Words{"manual"},
                               Words{"completion", "bash"}, Words{"generate", "random", "9", "-o", "-"}}) {
        phases.push_back({words[0] + " prints", words, {}, 500, {.out_file = pipe}});
        phases.push_back({words[0] + " prints", words, {}, 500, {.error_file = pipe, .out_file = pipe}});
    }
    if (!thorough()) phases.erase(phases.begin() + 2, phases.end() - 2);
    check_phases(folders, phases, quick(1, kSignals));
}

TEST_CASE("a signal ends a command whose driver does not answer", "[cli][signals]") {
    const Folders folders;
    check_phases(folders, {{"devices", {"devices"}, {}, 300, failing_device("clGetPlatformIDs 1 slow")}},
                 quick(1, kSignals));
}

}  // namespace
}  // namespace raya
