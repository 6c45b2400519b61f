#include "host/base/child_process.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "host/base/log.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

constexpr const char* kWorker = "--worker";

std::runtime_error system_error(const char* what) {
    return std::runtime_error(fmt::format("{}: {}", what, std::strerror(errno)));
}

// Runs the program in the forked child. This code runs between fork and exec, so it calls only functions that take no
// locks.
[[noreturn]] void exec_program(char* const* arguments, int pipe, int descriptor, pid_t parent) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);  // inherited through exec
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() == parent) {
        ::dup2(pipe, descriptor);
        ::close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);  // MPI's sockets belong to the parent
        ::fcntl(descriptor, F_SETFD, 0);                             // stays open through exec
        ::execvp(arguments[0], arguments);
    }
    ::_exit(kNotStarted);
}

[[noreturn]] void throw_sent(const std::string& kind, const std::string& error) {
    if (kind == "user") throw UserError(error);
    if (kind == "device") throw DeviceError(error);
    throw std::runtime_error(error);
}

}  // namespace

std::string ending_text(int status) {
    if (WIFEXITED(status)) return fmt::format("exit code {}", WEXITSTATUS(status));
    const char* name = ::sigabbrev_np(WTERMSIG(status));
    return fmt::format("signal {}{}", WTERMSIG(status), name != nullptr ? fmt::format(" (SIG{})", name) : "");
}

Child::Child(std::vector<std::string> arguments, int descriptor) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw system_error("cannot create a pipe to a child process");
    const pid_t parent = ::getpid();
    child_ = ::fork();
    if (child_ == 0) exec_program(argv.data(), ends[1], descriptor, parent);
    ::close(ends[1]);
    pipe_ = ends[0];
    if (child_ > 0) return;
    const std::runtime_error error = system_error("cannot start a child process");
    ::close(pipe_);
    throw error;
}

Child::~Child() {
    ::close(pipe_);
    if (child_ > 0) ::kill(child_, SIGKILL);
    wait();
}

std::optional<std::size_t> Child::read(char* bytes, std::size_t count, std::chrono::milliseconds wait) {
    pollfd in{pipe_, POLLIN, 0};
    const int ready = ::poll(&in, 1, static_cast<int>(wait.count()));
    if (ready == 0) {
        // The child may have ended without an end of file: a process that its driver started may hold the pipe open.
        if (child_ > 0 && ::waitpid(child_, &status_, WNOHANG) == child_) child_ = -1;
        return child_ < 0 ? std::optional<std::size_t>(0) : std::nullopt;
    }
    const ssize_t got = ready > 0 ? ::read(pipe_, bytes, count) : -1;
    if (got < 0 && errno == EINTR) return {};
    return static_cast<std::size_t>(std::max<ssize_t>(got, 0));
}

int Child::wait() {
    while (child_ > 0)
        if (::waitpid(child_, &status_, 0) == child_ || errno != EINTR) child_ = -1;
    return status_;
}

std::optional<int> run_child(const char* task, const Json& settings,
                             const std::function<bool(const Json& sent)>& take) {
    const Json request = {{"task", task}, {"verbosity", verbosity() - kErrorsOnly}, {"settings", settings}};
    Child child({"/proc/self/exe", kWorker, json_dump(request)});
    std::string unread;
    std::array<char, 4096> block{};
    for (;;) {
        const auto count = child.read(block.data(), block.size(), std::chrono::milliseconds(200));
        if (count == 0u) return child.wait();
        if (!count && !take(nullptr)) return {};
        unread.append(block.data(), count.value_or(0));
        for (std::size_t end = 0; (end = unread.find('\n')) != unread.npos; unread.erase(0, end + 1)) {
            const Json sent = parse_json(unread.substr(0, end), {"a child process"});
            if (sent.contains("error")) throw_sent(json_text(sent.at("kind")), json_text(sent.at("error")));
            if (!take(sent)) return {};
        }
    }
}

std::optional<WorkerRequest> worker_request(int argc, const char* const* argv) {
    if (argc != 3 || std::string_view(argv[1]) != kWorker) return {};
    ::fcntl(kReportDescriptor, F_SETFD, FD_CLOEXEC);
    return read_json(argv[2], {kWorker}, [](const Json& json) {
        set_verbosity(kErrorsOnly + static_cast<int>(json_integer(json.at("verbosity"), kDetailed - kErrorsOnly)));
        return WorkerRequest{.task = json_text(json.at("task")), .settings = json.at("settings")};
    });
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
