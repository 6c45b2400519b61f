#include "host/study/plotter.hpp"

#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <system_error>

#include "host/embedded.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

constexpr int kNoMatplotlib = 3;       // how tools/plot.py exits where it cannot import it
constexpr int kNoProgram = 127;        // how a shell's stand-in for python3 exits where there is none behind it
constexpr std::size_t kLongest = 300;  // characters of the script's last words in a reason

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;  // temporary: without a name, gone when closed

struct Attempt {
    bool drawn = false;
    bool go_on = false;  // another interpreter may do better
    std::string reason;
};

std::string message_of(int error) { return std::generic_category().message(error); }

// The script on its way in, read from its start. None where the disk has no room.
File script_file() {
    const std::string& script = embedded_files().at("tools/plot.py");
    File file(std::tmpfile());
    if (!file) return {};
    const bool written = std::fwrite(script.data(), 1, script.size(), file.get()) == script.size();
    if (!written || std::fflush(file.get()) != 0) return {};
    std::rewind(file.get());
    return file;
}

// The last line that says something: an exception's message ends its traceback.
std::string last_line(std::FILE* file) {
    std::rewind(file);
    std::string text;
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) text += static_cast<char>(c);
    const std::size_t end = text.find_last_not_of(" \r\n.");
    if (end == std::string::npos) return {};
    const std::size_t line = text.find_last_of('\n', end);
    const std::size_t start = line == std::string::npos ? 0 : line + 1;
    return text.substr(start, std::min(end + 1 - start, kLongest));
}

// Starts PYTHON - JSON with the script as its input and `said` for its output. No shell sees the path. Returns 0 or the
// errno of what failed.
int start(const std::string& python, const std::string& json, std::FILE* script, std::FILE* said, pid_t& child) {
    posix_spawn_file_actions_t actions;
    if (const int error = ::posix_spawn_file_actions_init(&actions)) return error;
    ::posix_spawn_file_actions_adddup2(&actions, ::fileno(script), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, ::fileno(said), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, ::fileno(said), STDERR_FILENO);
    std::string program = python, dash = "-", file = json;
    char* arguments[] = {program.data(), dash.data(), file.data(), nullptr};
    const int error = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
    ::posix_spawn_file_actions_destroy(&actions);
    return error;
}

int wait_for(pid_t child) {
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return status;
}

Attempt judge(const std::string& python, int status, std::FILE* said) {
    if (WIFSIGNALED(status)) return {.reason = fmt::format("{} was ended by signal {}", python, WTERMSIG(status))};
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (code == 0) return {.drawn = true, .reason = {}};
    if (code == kNoMatplotlib)
        return {.go_on = true, .reason = fmt::format("{} has no matplotlib: install python3-matplotlib", python)};
    const std::string words = last_line(said);
    return {.go_on = code == kNoProgram,
            .reason = fmt::format("{} failed with {}{}", python, code, words.empty() ? words : ": " + words)};
}

Attempt run_script(const std::string& python, const fs::path& json) {
    const File script = script_file(), said(std::tmpfile());
    if (!script || !said) return {.reason = "no temporary file: " + message_of(errno)};
    pid_t child = 0;
    if (const int error = start(python, json.string(), script.get(), said.get(), child))
        return {.go_on = true,
                .reason = fmt::format("cannot run {} ({}): install python3-matplotlib", python, message_of(error))};
    return judge(python, wait_for(child), said.get());
}

std::vector<std::string> interpreters() {
    const char* named = std::getenv("RAYA_PYTHON");
    if (named != nullptr && *named != '\0') return {named};
    return {"python3", "/usr/bin/python3"};  // the first may be somebody's own, without Debian's modules
}

std::vector<fs::path> plot_files(const fs::path& folder, const StudyPage& page) {
    std::vector<fs::path> files;
    for (const StudyPlot& plot : page.plots)
        for (const char* extension : {".svg", ".png"}) files.push_back(folder / (plot.name + extension));
    return files;
}

}  // namespace

PlotOutcome draw_plots(const fs::path& folder, const StudyPage& page) {
    if (page.plots.empty()) return {true, {}};
    const std::vector<fs::path> files = plot_files(folder, page);
    std::error_code error;
    for (const fs::path& file : files)
        if (!fs::is_directory(file, error)) fs::remove(file, error);  // one that stays is written over
    Attempt attempt{.go_on = true, .reason = {}};
    for (const std::string& python : interpreters())
        if (attempt.go_on) attempt = run_script(python, folder / (page.name + ".json"));
    if (!attempt.drawn) return {false, attempt.reason};
    for (const fs::path& file : files)
        if (!fs::is_regular_file(file, error)) return {false, "the script made no " + file.filename().string()};
    return {true, {}};
}

}  // namespace raya
