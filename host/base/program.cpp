#include "host/base/program.hpp"

#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "host/base/interruption.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;  // temporary: without a name, gone when closed

[[noreturn]] void fail() { throw std::system_error(errno, std::generic_category(), "no temporary file"); }

File file_of(const std::string& text) {
    File file(std::tmpfile());
    if (!file) fail();
    if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() || std::fflush(file.get()) != 0) fail();
    std::rewind(file.get());
    return file;
}

std::string text_of(std::FILE* file) {
    std::rewind(file);
    std::string text;
    char block[4096];
    while (const std::size_t count = std::fread(block, 1, sizeof block, file)) text.append(block, count);
    return text;
}

// Returns 0 or the errno of what failed.
int start(const std::vector<std::string>& arguments, const File (&streams)[3], pid_t& child) {
    posix_spawn_file_actions_t actions;
    if (const int error = ::posix_spawn_file_actions_init(&actions)) return error;
    for (int number = 0; number < 3; ++number)
        ::posix_spawn_file_actions_adddup2(&actions, ::fileno(streams[number].get()), number);
    std::vector<std::string> words = arguments;
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const int error = ::posix_spawnp(&child, pointers.front(), &actions, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    return error;
}

int wait_for(pid_t child) {
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return status;
}

}  // namespace

std::string ending_text(int status) {
    if (WIFEXITED(status)) return fmt::format("exit code {}", WEXITSTATUS(status));
    const char* name = ::sigabbrev_np(WTERMSIG(status));
    return fmt::format("signal {}{}", WTERMSIG(status), name != nullptr ? fmt::format(" (SIG{})", name) : "");
}

ProgramRun run_program(const std::vector<std::string>& arguments, const std::string& input) {
    const File streams[3] = {file_of(input), file_of({}), file_of({})};
    ProgramRun run;
    pid_t child = 0;
    run.not_started = start(arguments, streams, child);
    if (run.not_started != 0) return run;
    end_when_interrupted(child);
    run.status = wait_for(child);
    end_when_interrupted(0);
    run.out = text_of(streams[STDOUT_FILENO].get());
    run.err = text_of(streams[STDERR_FILENO].get());
    return run;
}

std::string last_line(const std::string& text) {
    constexpr std::size_t kLongest = 300;
    const std::size_t end = text.find_last_not_of(" \r\n.");
    if (end == std::string::npos) return {};
    const std::size_t line = text.find_last_of('\n', end);
    const std::size_t start = line == std::string::npos ? 0 : line + 1;
    return text.substr(start, std::min(end + 1 - start, kLongest));
}

std::optional<fs::path> program_beside_this(const std::string& name) {
    std::error_code failure;
    const fs::path program = fs::read_symlink("/proc/self/exe", failure).parent_path() / name;
    if (failure || !fs::is_regular_file(program, failure) || ::access(program.c_str(), X_OK) != 0) return {};
    return program;
}

}  // namespace raya
