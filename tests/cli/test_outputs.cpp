// Every output file of every command, from the rows of the parser, with faults: a full disk, failing writes, folders
// that are missing or not writable, signals. The file is whole, or what it was before; the error is one line.
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>

#include "host/cli/options.hpp"
#include "tests/cli/all_commands.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

constexpr const char* kOld = "old content";

/// A command with an option that names an output file.
struct OutputRow {
    Arguments arguments;    // of a fast run, without the option
    std::string option;     // --output
    std::string file;       // file name
    bool is_kept = true;    // the file exists after the run
    bool is_equal = false;  // two runs write equal files
};

/// Returns the rows of all output options of all commands. `inputs`: a folder with report.json. `others`: a folder for
/// output files of other options that the command requires.
std::vector<OutputRow> rows_of_outputs(const ScratchFolder& inputs, const ScratchFolder& others) {
    const Arguments small = {"--size", "16", "--lanes", "4", "--format", "fp32"};
    const std::map<std::string, Arguments> work = {// the fastest run of each command
                                                   {"render", small},
                                                   {"explore", small},
                                                   {"bench", Arguments{"--samples", "1"} + small},
                                                   {"verify", {"--only", "machine bus", "--lanes", "4"}},
                                                   {"balls", {"--level", "1"}},
                                                   {"lattice", {"--size", "1"}},
                                                   {"gears", {"--size", "1"}}};
    const std::map<std::string, Arguments> needed = {
        // by options
        {"--mask", {"--antialias", "supersample"}},
        {"--checkpoint", {"--checkpoint-every", "0", "--pes", "4", "--group", "1"}}};
    std::vector<OutputRow> rows;
    const auto program = make_full_parser();
    for_each_command(*program, [&](CLI::App& command, const Arguments& path) {
        for (const CLI::Option* option : command.get_options()) {
            if (file_use_of(*option) != FileUse::kWritten) continue;
            const std::string name = option->get_name(), type = option->get_type_name();
            OutputRow row{
                path, name,
                "x" + (type == "IMAGE" ? ".ppm" : type.substr(type.find('.'), type.find('[') - type.find('.')))};
            if (work.contains(path.back())) row.arguments = row.arguments + work.at(path.back());
            if (needed.contains(name)) row.arguments = row.arguments + needed.at(name);
            for (const CLI::Option* other : command.get_options()) {
                const std::string other_type = other->get_type_name();
                if (!other->get_required() || other == option) continue;
                if (!other->get_positional()) row.arguments.push_back(other->get_name());
                row.arguments.push_back(other_type == "SCENE"         ? scene_file("centre")
                                        : other_type == "REPORT.json" ? (inputs / "report.json").string()
                                        : other_type == "COUNT"       ? "5"
                                        : other_type == "XxYxZ"       ? "2x2x2"
                                                                      : (others / "other.ppm").string());
            }
            row.is_kept = name != "--checkpoint";
            row.is_equal = row.is_kept && (type == "IMAGE" || type == "SCENE.nff" || name == "--cost");
            rows.push_back(row);
        }
    });
    return rows;
}

RunOptions with_disk_faults(const std::string& variable, const std::string& fault,
                            const std::string& calls = "/dev/null") {
    return {.variables = {{"LD_PRELOAD", RAYA_DISK_FAULTS},
                          {variable, fault},
                          {"RAYA_WRITE_CALLS", calls},
                          {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0"}}};
}

/// The runs of one row, each in a new folder in which the file exists with kOld as content, except that of a
/// checkpoint.
class OutputTest {
  public:
    explicit OutputTest(const OutputRow& row) : row_(row) {
        const ScratchFolder logs;
        RunOutcome run = run_with(with_disk_faults("RAYA_WRITE_FAULT", "0 0", logs / "calls"));
        INFO(run.describe());
        REQUIRE(run.code == 0);
        REQUIRE(is_complete(content_));
        whole_ = content_;
        calls_ = lines_of(file_contents(logs / "calls"));
        REQUIRE(!calls_.empty());
    }

    /// A run that is refused before any work.
    void refused(const std::string& folder, const std::string& message, bool as_nobody = false) {
        RunOptions options{.as_nobody = as_nobody};
        const RunOutcome run = run_raya(row_.arguments + Arguments{row_.option, folder + row_.file}, options);
        check_error(run, 2, {message});
    }

    void full_disk(long bytes) {
        const RunOutcome run = run_with(with_disk_faults("RAYA_FULL_DISK", std::to_string(bytes) + " "), true);
        check_error(run, 2, {row_.file, "No space left on device", "free some space"});
        check_old();
    }

    /// Makes call number `number` fail with `error`: an errno, or 0 for a write of half the bytes.
    void failing_call(std::size_t number, int error) {
        const std::string fault = std::to_string(number) + (error == 0 ? " short" : " " + std::to_string(error));
        CAPTURE(fault, calls_.at(number - 1));
        const RunOutcome run = run_with(with_disk_faults("RAYA_WRITE_FAULT", fault));
        INFO(run.describe());
        if (run.code == 0) {  // repeated, or the call cannot fail in this way
            CHECK(is_complete(content_));
            return;
        }
        CHECK((error == ENOSPC || error == EIO));
        check_error(run, 2, {"raya: cannot ", std::generic_category().message(error)});
        check_old();
    }

    /// Sends the signal while the program is blocked in `call`, write() or rename() of the file.
    void interrupted(const std::string& call, int signal) {
        RunOptions options = with_disk_faults("RAYA_FULL_DISK", call + " ");
        options.signal = signal;
        options.signal_after_ms = 20;
        options.signal_count = 2;  // as timeout(1)
        RunOutcome run;
        for (int tries = 0; tries == 0 || (run.after_signal_s > 1 && tries < 3); ++tries) run = run_with(options, true);
        CAPTURE(call);
        CHECK(run.after_signal_s < 1);
        check_error(run, 128 + signal, {"raya: interrupted\n"});
        check_old();
    }

    std::size_t calls() const { return calls_.size(); }
    std::size_t bytes() const { return whole_.size(); }

  private:
    /// Runs the command. `in_folder`: the value of the second variable is completed by the name of the run's folder.
    RunOutcome run_with(RunOptions options, bool in_folder = false) {
        const ScratchFolder folder;
        const std::string path = fs::canonical(folder.path()).string();
        if (row_.is_kept) std::ofstream(folder / row_.file) << kOld;
        if (in_folder) options.variables[1].second += path;
        if (options.signal != 0) options.signal_when = [&] { return folder.entries() > (row_.is_kept ? 1 : 0); };
        const RunOutcome run = run_raya(row_.arguments + Arguments{row_.option, path + "/" + row_.file}, options);
        content_ = fs::exists(folder / row_.file) ? file_contents(folder / row_.file) : "";
        CHECK(folder.entries() <= 1);  // no temporary files
        return run;
    }

    bool is_complete(const std::string& content) const {
        if (!row_.is_kept) return content.empty();
        if (row_.is_equal && !whole_.empty()) return content == whole_;
        if (row_.file.ends_with(".json")) return Document::accept(content);
        return content != kOld && (!row_.file.ends_with(".html") || content.ends_with("</html>\n"));
    }

    void check_error(const RunOutcome& run, int code, const Arguments& message) const {
        INFO(run.describe());
        CHECK(run.code == code);
        const std::vector<std::string> lines = lines_of(run.messages());
        CHECK(std::ranges::count_if(lines, [](auto& line) { return !line.starts_with("raya: warning: "); }) == 1);
        for (const std::string& part : message) CHECK_THAT(run.err, Catch::Contains(part));
    }

    void check_old() const {
        if (row_.is_kept) CHECK(content_ == kOld);
        if (!row_.is_kept) CHECK((content_.empty() || content_.starts_with("raya")));  // a checkpoint
    }

    const OutputRow& row_;
    std::string whole_, content_;  // of the first and the last run
    std::vector<std::string> calls_;
};

TEST_CASE("every output of every command is whole or unchanged: full disk, failing writes, bad folders, signals",
          "[cli][outputs]") {
    const ScratchFolder inputs, others, locked;
    REQUIRE(run_raya({"render", scene_file("centre"), "--size", "16", "--lanes", "4", "-o", inputs / "y.ppm",
                      "--report", inputs / "report.json"})
                .code == 0);
    ::chmod(others.path().c_str(), 0777);
    ::chmod(locked.path().c_str(), 0555);
    const std::vector<OutputRow> rows = rows_of_outputs(inputs, others);
    CHECK(rows.size() >= 20);
    std::size_t turn = 0, interruptions = 0;  // unless thorough(), each row has some of the faults, the next row others
    const auto is_due = [&](std::size_t period) { return thorough() || turn % period == 0; };
    for (const OutputRow& row : rows) {
        CAPTURE(row.arguments, row.option);
        if (!thorough() && row.arguments[0] == "generate" && ++turn % 3 != 0) continue;
        OutputTest test(row);
        test.refused((others / "missing").string() + "/", "does not exist");
        if (row.is_kept) test.refused(locked.path().string() + "/", "is not writable", true);
        for (const long bytes : quick_rotating(std::vector<long>{1, static_cast<long>(test.bytes() / 2 + 1)}))
            test.full_disk(bytes);
        const std::vector<int> errors = {ENOSPC, EIO, EINTR, 0};
        // A page measures the device's peak rates for seconds in each run: one of its calls fails.
        const std::size_t period = row.option == "--page" ? test.calls() : 10;
        for (std::size_t call = 1; call <= test.calls(); ++call, ++turn)
            for (const int error : quick_rotating(errors))
                if (is_due(period)) test.failing_call(call, error);
        for (const char* call : quick_rotating(std::vector<const char*>{"write", "rename"}))
            for (const int signal : quick_rotating(std::vector<int>{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGINT}))
                if (row.is_kept && (thorough() || ++interruptions % 3 == 0)) test.interrupted(call, signal);
    }
}

/// A long computation: one lane, and at most the 2,000,000 pixels that a page may have.
Arguments long_work(const std::string& command, const Arguments& more) {
    return Arguments{command, scene_file("spheres"), "--size", "1400", "--lanes", "1", "--format", "e8m21"} + more;
}

TEST_CASE("signals end every command within a second while it reads, builds kernels, computes or prints",
          "[cli][signals]") {
    const ScratchFolder outputs, inputs;
    const std::string fifo = inputs / "never.nff", full = inputs / "full", out = outputs / "x.ppm",
                      page = outputs / "x.html";
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    REQUIRE(::mkfifo(full.c_str(), 0600) == 0);
    const int pipe = ::open(full.c_str(), O_RDWR | O_NONBLOCK);
    const std::string block(4096, 'x');
    while (::write(pipe, block.data(), block.size()) > 0) continue;
    struct Phase {
        Arguments arguments;
        int delay_ms = 100;
        bool is_quick = true, prints = false;
    };
    std::vector<Phase> phases = {
        {{"render", fifo, "-o", out}},   {{"bench", fifo}, 100, false},
        {{"info", fifo}, 100, false},    {{"explore", fifo, "-o", page}, 100, false},
        {{"page", fifo, "-o", page}},    {{"info", scene_file("planes")}, 500, true, true},
        {{"devices"}, 500, false, true}, {{"generate", "random", "9", "-o", "-"}, 500, true, true}};
    for (const int delay_ms : {0, 1500}) {  // while kernels are built, and while they run
        phases.push_back({long_work("render", {"-o", out, "--machine", "grande"}), delay_ms});
        phases.push_back({long_work("render", {"-o", out, "--machine", "torus", "--nodes", "2x2x1"}), delay_ms, false});
        phases.push_back({long_work("bench", {}), delay_ms, false});
        phases.push_back({long_work("explore", {"-o", page}), delay_ms, false});
        phases.push_back({{"verify", "--full", "--lanes", "1"}, delay_ms, false});
        if (RAYA_STUDIES) phases.push_back({{"study", "scale", "-o", inputs / "scale"}, delay_ms, false});
    }
    for (const Phase& phase : phases) {
        if (!phase.is_quick && !thorough()) continue;
        for (const int signal : quick_rotating(std::vector<int>{SIGINT, SIGTERM, SIGHUP, SIGQUIT})) {
            RunOptions options{.signal = signal, .signal_after_ms = phase.delay_ms, .signal_count = 2};
            if (phase.prints) options.out_file = full;
            RunOutcome run;
            for (int tries = 0; tries == 0 || (run.after_signal_s > 1 && tries < 3); ++tries)
                run = run_raya(phase.arguments, options);
            INFO(run.describe());
            CHECK(run.code == 128 + signal);
            CHECK(run.after_signal_s < 1);
            CHECK(run.err.ends_with("raya: interrupted\n"));
            CHECK(outputs.entries() == 0);
        }
    }
    ::close(pipe);
}

}  // namespace
}  // namespace raya
