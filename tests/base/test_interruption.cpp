// An interrupted process ends with the signal, prints a message, and leaves no partly written file.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "host/base/interruption.hpp"
#include "host/base/whole_file.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {

struct ChildEnd {
    int status = 0;  // as waitpid() returns it
    std::string output;
};

/// Runs `work` in a child process; returns the child's status and its output on stderr.
template <class Work>
ChildEnd in_child_process(const Work& work) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(ends[1], STDERR_FILENO);
        // Replaces Catch's handlers with the default handlers, with which a program starts.
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_DFL);
        work();
        ::_exit(99);
    }
    ::close(ends[1]);
    ChildEnd end;
    std::array<char, 256> block{};
    for (ssize_t read = 0; (read = ::read(ends[0], block.data(), block.size())) > 0;)
        end.output.append(block.data(), static_cast<std::size_t>(read));
    ::close(ends[0]);
    ::waitpid(child, &end.status, 0);
    return end;
}

/// Calls `interrupt` when a file of this process reaches `bytes` bytes, during a write.
void interrupt_at_size(rlim_t bytes, void (*interrupt)(int)) {
    std::signal(SIGXFSZ, interrupt);
    const rlimit limit{bytes, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
}

TEST_CASE("an interruption while a file is written removes the written part", "[interruption]") {
    const ScratchFolder folder;
    std::ofstream(folder / "old") << "as it was";
    const std::string bytes(100'000, 'x');
    for (const char* name : {"new", "old"}) {
        CAPTURE(name);
        const ChildEnd end = in_child_process([&] {
            install_interrupt_handlers();
            interrupt_at_size(50'000, [](int) { ::raise(SIGINT); });
            write_whole_file(folder / name, bytes);
        });
        CHECK(WIFSIGNALED(end.status));
        CHECK(WTERMSIG(end.status) == SIGINT);
        CHECK(end.output == "raya: interrupted\n");
        CHECK(folder.entries() == 1);  // the old file
        std::ifstream old(folder / "old");
        CHECK(std::string(std::istreambuf_iterator<char>(old), {}) == "as it was");
    }
}

TEST_CASE("each signal ends the process with the signal's own status, and no library's handler replaces raya's",
          "[interruption]") {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        CAPTURE(signal);
        const ChildEnd end = in_child_process([&] {
            install_interrupt_handlers();
            struct sigaction action {};
            action.sa_handler = [](int) {};
            ::sigaction(signal, &action, nullptr);
            ::raise(signal);
        });
        CHECK(WIFSIGNALED(end.status));
        CHECK(WTERMSIG(end.status) == signal);
        CHECK(end.output == "raya: interrupted\n");
    }
}

TEST_CASE("a signal that the caller ignores stays ignored, as under nohup", "[interruption]") {
    const ChildEnd end = in_child_process([] {
        std::signal(SIGHUP, SIG_IGN);
        install_interrupt_handlers();
        ::raise(SIGHUP);
    });
    CHECK(WIFEXITED(end.status));
    CHECK(WEXITSTATUS(end.status) == 99);
    CHECK(end.output.empty());
}

TEST_CASE("an interruption removes only the file in progress", "[interruption]") {
    const ScratchFolder folder;
    const ChildEnd end = in_child_process([&] {
        install_interrupt_handlers();
        for (const char* name : {"done", "in progress"}) {
            const FileInProgress file(folder / name);
            std::ofstream(folder / name) << name;
            if (name == std::string("in progress")) ::raise(SIGTERM);
        }
    });
    CHECK(WTERMSIG(end.status) == SIGTERM);
    CHECK(std::filesystem::exists(folder / "done"));
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
