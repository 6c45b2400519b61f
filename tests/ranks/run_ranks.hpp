// Runs raya under mpirun with one process per rank. Records the output, the exit code and the number of processes that
// do not end by themselves.
#pragma once
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "tests/cli/refusals.hpp"

namespace raya {

/// An MPI library.
struct Mpi {
    std::string launcher;  // path of its mpirun; empty: not installed
    std::string program;   // path of a raya executable whose raya_mpi.so is built with this library
};

/// Returns the MPI library with which RAYA_PROGRAM was built. If none is installed, prints a warning and returns an
/// empty list, so that the test passes.
inline std::vector<Mpi> installed_mpis() {
    std::vector<Mpi> installed;
    if (const Mpi mpi{RAYA_MPIRUN, RAYA_PROGRAM}; !mpi.launcher.empty()) installed.push_back(mpi);
    if (installed.empty()) WARN("no MPI library is installed: the tests that run raya under mpirun are skipped");
    return installed;
}

/// Fault injection: one process receives a signal `after_ms` ms after all ranks have started.
struct RanksFault {
    int signal = 0;                       // 0: no fault
    std::optional<std::uint32_t> rank{};  // the rank that receives the signal; empty: mpirun
    int after_ms = 700;
};

/// Result of a run under mpirun.
struct RanksOutcome : RunOutcome {
    static constexpr int kKilled = 124;  // code of a run that did not end within 60 s
    std::size_t remaining = 0;           // number of processes that did not end by themselves
    std::size_t messages = 0;            // number of lines on stderr that start with "raya:"
};

namespace run_ranks_detail {

using Clock = std::chrono::steady_clock;
inline constexpr const char* kRunMark = "RAYA_TEST_RUN=";

struct RankProcess {
    pid_t process = 0;
    std::uint32_t rank = 0;
};

/// Returns the value of the variable `name`; empty if the variable is not set. `environment`: text of
/// /proc/PID/environ.
inline std::string variable_of(const std::string& environment, const std::string& name) {
    const std::size_t position = ('\0' + environment).find('\0' + name + "=");
    return position == environment.npos ? "" : std::string(environment.c_str() + position + name.size() + 1);
}

/// Returns the contents of a file of /proc/PID/.
inline std::string process_file(const std::filesystem::path& folder, const char* name) {
    std::ifstream file(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns the live processes whose environment contains `mark`, with their environments. Zombies are omitted, because
/// their environment is empty.
inline std::vector<std::pair<pid_t, std::string>> marked_processes(const std::string& mark) {
    std::vector<std::pair<pid_t, std::string>> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
        const std::string name = entry.path().filename();
        if (name.find_first_not_of("0123456789") != name.npos) continue;
        const std::string environment = process_file(entry.path(), "environ");
        if (environment.find(mark) != environment.npos) found.emplace_back(std::stoi(name), environment);
    }
    return found;
}

/// Returns the processes of the ranks, without the child processes in which `raya verify` runs its checks.
inline std::vector<RankProcess> rank_processes(const std::string& mark, const std::string& program) {
    std::vector<RankProcess> ranks;
    for (const auto& [process, environment] : marked_processes(mark)) {
        std::error_code error;
        const std::filesystem::path folder = "/proc/" + std::to_string(process);
        const auto exe = std::filesystem::read_symlink(folder / "exe", error);
        if (error || exe != std::filesystem::canonical(program)) continue;
        if (process_file(folder, "cmdline").find("--worker") != std::string::npos) continue;
        std::string rank = variable_of(environment, "OMPI_COMM_WORLD_RANK");
        if (rank.empty()) rank = variable_of(environment, "PMI_RANK");
        if (!rank.empty()) ranks.push_back({process, static_cast<std::uint32_t>(std::stoul(rank))});
    }
    return ranks;
}

inline pid_t start(const Mpi& mpi, std::vector<std::string> arguments, std::vector<std::string> variables,
                   std::FILE* out, std::FILE* err) {
    arguments.insert(arguments.begin(), {mpi.launcher, "--bind-to", "none"});
    const std::vector<char*> argv = run_program_detail::pointers(arguments);
    const std::vector<char*> envp = run_program_detail::pointers(variables);
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::setsid();
    const int null_device = ::open("/dev/null", O_RDONLY);
    ::dup2(null_device, STDIN_FILENO);
    ::dup2(::fileno(out), STDOUT_FILENO);
    ::dup2(::fileno(err), STDERR_FILENO);
    ::execve(argv[0], argv.data(), envp.data());
    ::_exit(127);
}

/// Waits until `ranks` ranks have loaded PoCL, which follows MPI_Init (2 s in Open MPI 6), or, with another driver, for
/// 10 s; then for fault.after_ms ms, and sends fault.signal. Returns false if the ranks do not start within 30 s or the
/// signal cannot be sent.
inline bool send_signal(const Mpi& mpi, const std::string& mark, pid_t launcher, std::size_t ranks,
                        const RanksFault& fault) {
    const Clock::time_point deadline = Clock::now() + std::chrono::seconds(30);
    std::vector<RankProcess> started;
    while ((started = rank_processes(mark, mpi.program)).size() < ranks) {
        if (Clock::now() > deadline || run_program_detail::has_ended(launcher)) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const auto has_driver = [](const RankProcess& rank) {
        return process_file("/proc/" + std::to_string(rank.process), "maps").find("libpocl") != std::string::npos;
    };
    const Clock::time_point latest = Clock::now() + std::chrono::seconds(10);
    while (!std::all_of(started.begin(), started.end(), has_driver) && Clock::now() < latest)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::this_thread::sleep_for(std::chrono::milliseconds(fault.after_ms));
    pid_t target = launcher;
    for (const RankProcess& p : started)
        if (fault.rank == p.rank) target = p.process;
    return ::kill(target, fault.signal) == 0;
}

inline std::size_t count_raya_lines(const std::string& text) {
    std::size_t lines = 0;
    for (std::size_t begin = 0; (begin = ("\n" + text).find("\nraya:", begin)) != text.npos; ++begin) ++lines;
    return lines;
}

}  // namespace run_ranks_detail

/// Runs the launcher with `arguments`, which must include the path of the program. A run that does not end within 60 s
/// is killed and has the exit code kKilled. `ranks`: number of ranks that must have started before the signal of
/// `fault` is sent. Throws std::runtime_error if the signal cannot be sent.
inline RanksOutcome run_ranks(const Mpi& mpi, const std::vector<std::string>& arguments, std::size_t ranks = 0,
                              const RanksFault& fault = {}, RunOptions run_options = {}) {
    namespace detail = run_ranks_detail;
    using detail::Clock;
    constexpr int kLimit_s = 60;
    static int runs = 0;
    const std::string run_id = std::to_string(::getpid()) + "." + std::to_string(++runs),
                      mark = detail::kRunMark + run_id;
    run_options.variables.emplace_back("RAYA_TEST_RUN", run_id);
    RanksOutcome outcome;
    outcome.command = mpi.launcher;
    for (const std::string& argument : arguments) outcome.command += " " + argument;
    const run_program_detail::File out = run_program_detail::temporary_file(),
                                   err = run_program_detail::temporary_file();
    const pid_t child =
        detail::start(mpi, arguments, run_program_detail::environment(run_options), out.get(), err.get());
    const bool sent = fault.signal == 0 || detail::send_signal(mpi, mark, child, ranks, fault);
    const Clock::time_point start = Clock::now();
    const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(10)); };
    int status = 0;
    const auto timed_out = [&] { return Clock::now() - start > std::chrono::seconds(kLimit_s); };
    while (::waitpid(child, &status, WNOHANG) == 0 && !timed_out()) pause();
    outcome.code = timed_out()         ? RanksOutcome::kKilled
                   : WIFEXITED(status) ? WEXITSTATUS(status)
                                       : 128 + WTERMSIG(status);
    const Clock::time_point deadline = Clock::now() + std::chrono::seconds(8);
    while (!detail::marked_processes(mark).empty() && Clock::now() < deadline && !timed_out()) pause();
    for (const auto& [process, environment] : detail::marked_processes(mark)) {
        ++outcome.remaining;
        ::kill(process, SIGKILL);
    }
    if (timed_out()) ::waitpid(child, &status, 0);
    outcome.out = run_program_detail::contents(out.get());
    outcome.err = run_program_detail::contents(err.get());
    outcome.messages = detail::count_raya_lines(outcome.err);
    if (!sent) throw std::runtime_error("the ranks did not start in time for the signal: " + outcome.describe());
    return outcome;
}

/// A shell script that runs a program. On one rank it evaluates a shell command before it runs the program.
class RankScript {
  public:
    RankScript() {
        std::ofstream(script_) << "#!/bin/sh\nonly_rank=$1; command=$2; shift 2\n"
                                  "[ \"${OMPI_COMM_WORLD_RANK:-$PMI_RANK}\" = \"$only_rank\" ] && eval \"$command\"\n"
                                  "exec \"$@\"\n";
        ::chmod(script_.c_str(), 0755);
    }

    /// Returns arguments of mpirun. `command`: for the rank `rank`.
    Arguments arguments(const Mpi& mpi, std::uint32_t ranks, std::uint32_t rank, const std::string& command,
                        const Arguments& program_arguments) const {
        Arguments launched = {"-n", std::to_string(ranks), script_, std::to_string(rank), command, mpi.program};
        launched.insert(launched.end(), program_arguments.begin(), program_arguments.end());
        return launched;
    }

  private:
    ScratchFolder folder_;
    std::string script_ = folder_ / "one_rank.sh";
};

}  // namespace raya
