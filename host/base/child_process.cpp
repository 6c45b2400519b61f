#include "host/base/child_process.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "host/base/log.hpp"

namespace raya {
namespace {

constexpr const char* kOwnProgram = "/proc/self/exe";
constexpr const char* kWorker = "--worker";

std::runtime_error system_error(const char* what) {
    return std::runtime_error(fmt::format("{}: {}", what, std::strerror(errno)));
}

// Runs the program in the forked child. This code runs between fork and exec, so it calls only functions that take no
// locks.
[[noreturn]] void exec_program(const char* program, char* const* arguments, int kept, pid_t parent) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);  // inherited through exec
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() == parent) {
        ::close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);  // MPI's sockets belong to the parent
        ::fcntl(kept, F_SETFD, 0);                                   // stays open through exec
        ::execv(program, arguments);
    }
    ::_exit(kNotStarted);
}

}  // namespace

std::string ending_text(int status) {
    if (WIFEXITED(status)) return fmt::format("exit code {}", WEXITSTATUS(status));
    const char* name = ::sigabbrev_np(WTERMSIG(status));
    return fmt::format("signal {}{}", WTERMSIG(status), name != nullptr ? fmt::format(" (SIG{})", name) : "");
}

pid_t start_child(const std::string& program, std::vector<std::string> arguments, int kept) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child == 0) exec_program(program.c_str(), argv.data(), kept, parent);
    if (child < 0) throw system_error("cannot start a child process");
    return child;
}

ChildProcess::ChildProcess(const char* task, const Json& settings) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw system_error("cannot create a pipe to a child process");
    const Json request = {
        {"task", task}, {"lines", ends[1]}, {"verbosity", verbosity() - kErrorsOnly}, {"settings", settings}};
    pipe_ = ends[0];
    try {
        child_ = start_child(kOwnProgram, {"raya", kWorker, json_dump(request)}, ends[1]);
    } catch (...) {
        for (const int end : ends) ::close(end);
        throw;
    }
    ::close(ends[1]);
}

ChildProcess::~ChildProcess() {
    ::close(pipe_);
    if (ended_) return;
    ::kill(child_, SIGKILL);
    wait();
}

bool ChildProcess::take_line(std::string& line) {
    const std::size_t end = unread_text_.find('\n');
    if (end == std::string::npos) return false;
    line = unread_text_.substr(0, end);
    unread_text_.erase(0, end + 1);
    return true;
}

bool ChildProcess::check_ended() {
    if (!ended_) ended_ = ::waitpid(child_, &status_, WNOHANG) == child_;
    return ended_;
}

ChildProcess::Read ChildProcess::read(std::string& line, std::chrono::milliseconds wait) {
    while (!take_line(line)) {
        pollfd in{pipe_, POLLIN, 0};
        const int ready = ::poll(&in, 1, static_cast<int>(wait.count()));
        // The child may have ended without an end of file: a process that its driver started may hold the pipe open.
        if (ready == 0) return check_ended() ? Read::kEnd : Read::kNothing;
        std::array<char, 4096> block{};
        const ssize_t count = ready > 0 ? ::read(pipe_, block.data(), block.size()) : -1;
        if (count > 0)
            unread_text_.append(block.data(), static_cast<std::size_t>(count));
        else if (count == 0 || errno != EINTR)
            return Read::kEnd;
    }
    return Read::kLine;
}

int ChildProcess::wait() {
    while (!ended_) ended_ = ::waitpid(child_, &status_, 0) == child_ || errno != EINTR;
    return status_;
}

std::optional<WorkerRequest> worker_request(int argc, const char* const* argv) {
    if (argc != 3 || std::string_view(argv[1]) != kWorker) return {};
    WorkerRequest request = read_json(argv[2], {kWorker}, [](const Json& json) {
        set_verbosity(kErrorsOnly + static_cast<int>(json_integer(json.at("verbosity"), kDetailed - kErrorsOnly)));
        return WorkerRequest{json_text(json.at("task")), static_cast<int>(json_integer(json.at("lines"), INT_MAX)),
                             json.at("settings")};
    });
    ::fcntl(request.pipe, F_SETFD, FD_CLOEXEC);
    return request;
}

void send_line(int pipe, const Json& object) {
    const std::string text = json_dump(object) + "\n";
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = ::write(pipe, text.data() + sent, text.size() - sent);
        if (count < 0 && errno != EINTR) return;
        if (count > 0) sent += static_cast<std::size_t>(count);
    }
}

}  // namespace raya
