// Runs the built program in a separate process, as a user does, and returns its output and exit code.
#pragma once
#include <fcntl.h>
#include <grp.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "tests/paths.h"

namespace raya {

struct RunOutcome {
    std::string command;        // command line, for messages of failed tests
    int code = 0;               // exit code; 128 + signal number if a signal ended the program
    double after_signal_s = 0;  // seconds from the signal to the end of the process
    std::string out, err;
    /// Returns stderr without the lines about compiling, which depend on the cache and on the computer's load.
    std::string messages() const { return std::regex_replace(err, std::regex("raya: compiling kernels [^\n]*\n"), ""); }
    /// Returns command, exit code, stdout and stderr, for messages of failed tests.
    std::string describe() const { return command + "\nexit code " + std::to_string(code) + "\n" + out + "\n" + err; }
};

/// Environment, limits and redirections of a run.
struct RunOptions {
    std::vector<std::pair<std::string, std::string>> variables{};  // [name, value], added to the test's environment
    bool as_nobody = false;       // run as user nobody if root runs the test, so that permissions apply
    rlim_t max_file_bytes = 0;    // RLIMIT_FSIZE in bytes, 0: no limit; a longer write fails with EFBIG
    rlim_t max_memory_bytes = 0;  // RLIMIT_AS in bytes, 0: no limit
    std::string error_file{};     // file that stderr is written to; empty: RunOutcome::err
    std::string program = RAYA_PROGRAM;
    int signal = 0;                       // signal number, sent to the program unless it has ended; 0: none
    int signal_after_ms = 0;              // delay after the program has set a handler and signal_when is true
    std::function<bool()> signal_when{};  // condition for the signal, polled; empty: always true
    int signal_count = 1;                 // number of times that the signal is sent; timeout(1) sends it twice
    std::string out_file{};               // file that stdout is written to; empty: RunOutcome::out
};

namespace run_program_detail {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

inline File temporary_file() {
    File file(std::tmpfile(), &std::fclose);
    if (!file) throw std::runtime_error("no temporary file");
    return file;
}

inline std::string contents(std::FILE* file) {
    std::rewind(file);
    std::string text;
    std::array<char, 4096> block{};
    while (const std::size_t read = std::fread(block.data(), 1, block.size(), file)) text.append(block.data(), read);
    return text;
}

/// Returns pointers to the texts and a final null pointer, as exec() expects them.
inline std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

inline std::vector<std::string> environment(const RunOptions& options) {
    std::vector<std::string> all;
    for (char** variable = environ; *variable != nullptr; ++variable) {
        const std::string_view text = *variable;
        bool replaced = false;
        // Removes RAYA_KERNEL_LOG if a library is preloaded: the library counts writes, and the log adds some.
        for (const auto& [name, value] : options.variables)
            replaced = replaced || text.starts_with(name + "=") ||
                       (name == "LD_PRELOAD" && text.starts_with("RAYA_KERNEL_LOG="));
        if (!replaced) all.emplace_back(text);
    }
    for (const auto& [name, value] : options.variables) all.push_back(name + "=" + value);
    return all;
}

/// Redirects descriptor `stream` to `file`, which may be a terminal.
inline void redirect_stream(const std::string& file, int stream) {
    if (file.empty()) return;
    const int opened = ::open(file.c_str(), O_WRONLY | O_NOCTTY);
    if (opened < 0 || ::dup2(opened, stream) < 0) ::_exit(126);
}

inline void become_nobody() {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() != 0) return;
    if (::setgroups(0, nullptr) != 0 || ::setgid(kNobody) != 0 || ::setuid(kNobody) != 0) ::_exit(126);
}

inline void limit_files(rlim_t bytes) {
    if (bytes == 0) return;
    std::signal(SIGXFSZ, SIG_IGN);  // raya inherits this setting: its writes beyond the limit fail with EFBIG
    const rlimit limit{bytes, bytes};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(126);
}

inline void limit_memory(rlim_t bytes) {
    const rlimit limit{bytes, bytes};
    if (bytes != 0 && ::setrlimit(RLIMIT_AS, &limit) != 0) ::_exit(126);
}

/// Returns true if the child runs raya and has a handler for the signal (SigCgt in proc(5)). Returns false before the
/// child executes raya: until then it has the handlers of this process.
inline bool has_handler(pid_t child, int signal) {
    const std::string folder = "/proc/" + std::to_string(child);
    std::error_code ended;
    const auto program = std::filesystem::read_symlink(folder + "/exe", ended);
    if (ended || program == std::filesystem::read_symlink("/proc/self/exe")) return false;
    std::ifstream status(folder + "/status");
    for (std::string field; status >> field;) {
        if (field != "SigCgt:") continue;
        status >> field;
        return (std::stoull(field, nullptr, 16) >> (signal - 1) & 1) != 0;
    }
    return false;
}

/// Returns true if the child has ended. Does not reap it.
inline bool has_ended(pid_t child) {
    siginfo_t found{};
    return ::waitid(P_PID, static_cast<id_t>(child), &found, WEXITED | WNOHANG | WNOWAIT) != 0 || found.si_pid != 0;
}

/// Waits for the conditions in `options`, at most 60 s, then sends the signal. The caller has not reaped the child, so
/// the child's process ID is valid.
inline void send_signal(pid_t child, const RunOptions& options) {
    using namespace std::chrono;
    if (options.signal == 0) return;
    const auto deadline = steady_clock::now() + seconds(60);
    const auto ready = [&] {
        return has_handler(child, options.signal) && (!options.signal_when || options.signal_when());
    };
    while (!ready() && !has_ended(child) && steady_clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(5));
    std::this_thread::sleep_for(milliseconds(options.signal_after_ms));
    for (int sent = 0; sent < options.signal_count; ++sent) ::kill(child, options.signal);
}

}  // namespace run_program_detail

/// Runs raya with these arguments and empty stdin, without a shell, and waits until it ends. Throws std::runtime_error
/// if raya cannot be started.
inline RunOutcome run_raya(std::vector<std::string> arguments, const RunOptions& options = {}) {
    namespace detail = run_program_detail;
    RunOutcome outcome;
    outcome.command = "raya";
    for (const std::string& argument : arguments) outcome.command += " '" + argument + "'";
    arguments.insert(arguments.begin(), "raya");
    std::vector<std::string> variables = detail::environment(options);
    const std::vector<char*> argv = detail::pointers(arguments), envp = detail::pointers(variables);
    const detail::File input = detail::temporary_file(), out = detail::temporary_file(), err = detail::temporary_file();
    // Opens the program before the fork, because user nobody may have no access to the build folder.
    const int program = ::open(options.program.c_str(), O_RDONLY | O_CLOEXEC);
    const pid_t child = program < 0 ? -1 : ::fork();
    if (child == 0) {
        ::dup2(::fileno(input.get()), STDIN_FILENO);
        ::dup2(::fileno(out.get()), STDOUT_FILENO);
        ::dup2(::fileno(err.get()), STDERR_FILENO);
        detail::redirect_stream(options.out_file, STDOUT_FILENO);
        detail::redirect_stream(options.error_file, STDERR_FILENO);
        detail::limit_files(options.max_file_bytes);
        // A shell starts commands in the background with ignored signals, and raya does not handle ignored SIGHUP and
        // SIGQUIT.
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_DFL);
        if (options.as_nobody) detail::become_nobody();
        detail::limit_memory(options.max_memory_bytes);
        ::fexecve(program, argv.data(), envp.data());
        ::_exit(127);
    }
    if (program >= 0) ::close(program);
    if (child > 0) detail::send_signal(child, options);
    const auto signalled = std::chrono::steady_clock::now();
    int status = 0;
    while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    outcome.after_signal_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - signalled).count();
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.out = detail::contents(out.get());
    outcome.err = detail::contents(err.get());
    if (child < 0 || outcome.code == 126 || outcome.code == 127)
        throw std::runtime_error("cannot run " + options.program + ": " + outcome.describe());
    return outcome;
}

/// Returns the path of scenes/NAME.nff.
inline std::string scene_file(const std::string& name) { return RAYA_SOURCE_DIR "/scenes/" + name + ".nff"; }

inline std::string file_contents(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + path.string());
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns true if a line of the text matches the regular expression. Matches each line separately, because std::regex
/// recurses once per character and would overflow the stack on a long text.
inline bool has_line(const std::string& text, const std::string& pattern) {
    const std::regex regex(pattern);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (std::regex_match(line, regex)) return true;
    return false;
}

using Arguments = std::vector<std::string>;

/// Splits a line at blanks.
inline Arguments tokens_of(const std::string& line) {
    std::istringstream text(line);
    return {std::istream_iterator<std::string>(text), {}};
}

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) all.push_back(line);
    return all;
}

inline bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

}  // namespace raya
