// Runs raya on ranks as a user does: mpirun, a process for each rank, seen from outside by what they print, the exit
// code, and what is left of them.
#pragma once
#include <catch2/catch.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace raya {

/// An MPI: its launcher, and a raya with a module for it.
struct Mpi {
    std::string launcher, program;
};

/// The MPI that this raya was built with and, where there is another one, that too; without any a test says so and
/// passes.
inline std::vector<Mpi> mpis_here() {
    std::vector<Mpi> all;
    for (const Mpi& mpi : {Mpi{RAYA_MPIRUN_OWN, RAYA_PROGRAM}, Mpi{RAYA_MPIRUN_OTHER, RAYA_OTHER_MPI "/raya"}})
        if (!mpi.launcher.empty()) all.push_back(mpi);
    if (all.empty()) WARN("no MPI here: nothing is tested on ranks that are processes");
    return all;
}

/// What happens to a run: one process gets a signal some time after all ranks have started.
struct RanksFault {
    int signal = 0;                       // 0: nothing happens
    std::optional<std::uint32_t> rank{};  // whom it hits; empty: mpirun
    int after_ms = 700;
};

struct RanksOutcome : RunOutcome {
    double seconds = 0;        // from the fault, or else from the start, to the end of the last process
    std::size_t left = 0;      // processes that did not end
    std::size_t messages = 0;  // lines of raya's own on stderr
};

namespace run_ranks_detail {

using Clock = std::chrono::steady_clock;
inline constexpr const char* kMark = "RAYA_TEST_RUN=";

struct RankProcess {
    pid_t process = 0;
    std::uint32_t rank = 0;
};

/// The value of a variable in /proc's environ; empty where it is not there.
inline std::string variable_of(const std::string& environment, const std::string& name) {
    const std::size_t at = ('\0' + environment).find('\0' + name + "=");
    return at == environment.npos ? "" : std::string(environment.c_str() + at + name.size() + 1);
}

/// Processes that bear the mark and live; those that have ended and are not waited for have no environment.
inline std::vector<std::pair<pid_t, std::string>> marked(const std::string& mark) {
    std::vector<std::pair<pid_t, std::string>> found;
    std::error_code gone;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
        const std::string name = entry.path().filename();
        if (name.find_first_not_of("0123456789") != name.npos) continue;
        std::ifstream file(entry.path() / "environ", std::ios::binary);
        const std::string environment{std::istreambuf_iterator<char>(file), {}};
        if (environment.find(mark) != environment.npos) found.emplace_back(std::stoi(name), environment);
    }
    return found;
}

inline std::vector<RankProcess> rank_processes(const std::string& mark, const std::string& program) {
    std::vector<RankProcess> ranks;
    for (const auto& [process, environment] : marked(mark)) {
        std::error_code gone;
        const auto exe = std::filesystem::read_symlink("/proc/" + std::to_string(process) + "/exe", gone);
        if (gone || exe != std::filesystem::canonical(program)) continue;
        std::string rank = variable_of(environment, "OMPI_COMM_WORLD_RANK");
        if (rank.empty()) rank = variable_of(environment, "PMI_RANK");
        if (!rank.empty()) ranks.push_back({process, static_cast<std::uint32_t>(std::stoul(rank))});
    }
    return ranks;
}

inline pid_t start(const Mpi& mpi, std::vector<std::string> words, std::vector<std::string> variables, std::FILE* out,
                   std::FILE* err) {
    words.insert(words.begin(), {mpi.launcher, "--bind-to", "none"});
    const std::vector<char*> argv = run_program_detail::pointers(words), envp = run_program_detail::pointers(variables);
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::setsid();
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(::fileno(out), STDOUT_FILENO);
    ::dup2(::fileno(err), STDERR_FILENO);
    ::execve(argv[0], argv.data(), envp.data());
    ::_exit(127);
}

/// Sends the signal when `ranks` of them have started; false where they have not within 30 s.
inline bool strike(const Mpi& mpi, const std::string& mark, pid_t launcher, std::size_t ranks, const RanksFault& f) {
    const Clock::time_point late = Clock::now() + std::chrono::seconds(30);
    std::vector<RankProcess> there;
    while ((there = rank_processes(mark, mpi.program)).size() < ranks) {
        if (Clock::now() > late || run_program_detail::has_ended(launcher)) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(f.after_ms));
    pid_t whom = launcher;
    for (const RankProcess& p : there)
        if (f.rank == p.rank) whom = p.process;
    return ::kill(whom, f.signal) == 0;
}

inline std::size_t own_lines(const std::string& text) {
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = ("\n" + text).find("\nraya:", at)) != text.npos; ++at) ++lines;
    return lines;
}

}  // namespace run_ranks_detail

/// `words`: what follows the launcher's name, the program among them. Ends what does not end within `limit_s`, with
/// exit code 124.
inline RanksOutcome run_ranks(const Mpi& mpi, const std::vector<std::string>& words, std::size_t ranks = 0,
                              const RanksFault& fault = {}, Surroundings around = {}) {
    namespace detail = run_ranks_detail;
    using detail::Clock;
    constexpr int kLimit_s = 60;
    static int runs = 0;
    const std::string value = std::to_string(::getpid()) + "." + std::to_string(++runs), mark = detail::kMark + value;
    around.variables.insert(around.variables.end(), {{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                                                     {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
                                                     {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
                                                     {"RAYA_TEST_RUN", value}});
    RanksOutcome outcome;
    outcome.command = mpi.launcher;
    for (const std::string& word : words) outcome.command += " " + word;
    const run_program_detail::File out = run_program_detail::temporary_file(),
                                   err = run_program_detail::temporary_file();
    const pid_t child = detail::start(mpi, words, run_program_detail::environment(around), out.get(), err.get());
    const bool struck = fault.signal == 0 || detail::strike(mpi, mark, child, ranks, fault);
    const Clock::time_point start = Clock::now();
    const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(10)); };
    int status = 0;
    const auto late = [&] { return Clock::now() - start > std::chrono::seconds(kLimit_s); };
    while (::waitpid(child, &status, WNOHANG) == 0 && !late()) pause();
    outcome.code = late() ? 124 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    const Clock::time_point patience = Clock::now() + std::chrono::seconds(8);
    while (!detail::marked(mark).empty() && Clock::now() < patience && !late()) pause();
    for (const auto& [process, environment] : detail::marked(mark)) {
        ++outcome.left;
        ::kill(process, SIGKILL);
    }
    if (late()) ::waitpid(child, &status, 0);
    outcome.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    outcome.out = run_program_detail::contents(out.get());
    outcome.err = run_program_detail::contents(err.get());
    outcome.messages = detail::own_lines(outcome.err);
    if (!struck) throw std::runtime_error("the ranks were not there to be hit: " + outcome.told());
    return outcome;
}

}  // namespace raya
