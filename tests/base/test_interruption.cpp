// An interrupted process ends with the signal, prints a message, and leaves no partly written file.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
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

TEST_CASE("an interruption while a file is written removes only the written part", "[interruption]") {
    const ScratchFolder folder;
    std::ofstream(folder / "old") << "as it was";
    for (const char* name : {"new", "old"}) {
        CAPTURE(name);
        const ChildEnd end = in_child_process([&] {
            install_interrupt_handlers();
            write_whole_file(folder / "done", "whole");
            std::signal(SIGXFSZ, [](int) { ::raise(SIGINT); });  // during a write
            const rlimit limit{50'000, RLIM_INFINITY};
            ::setrlimit(RLIMIT_FSIZE, &limit);
            write_whole_file(folder / name, std::string(100'000, 'x'));
        });
        CHECK(WTERMSIG(end.status) == SIGINT);
        CHECK(end.output == "raya: interrupted\n");
        CHECK(folder.entries() == 2);
        CHECK(read_file(folder / "old") == "as it was");
        CHECK(read_file(folder / "done") == "whole");
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

}  // namespace
}  // namespace raya
