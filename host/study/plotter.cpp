#include "host/study/plotter.hpp"

#include <fmt/core.h>
#include <sys/wait.h>

#include <cstdlib>
#include <system_error>

#include "host/base/program.hpp"
#include "host/embedded.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

constexpr int kNoMatplotlib = 3;  // how tools/plot.py exits where it cannot import it
constexpr int kNoProgram = 127;   // how a shell's stand-in for python3 exits where there is none behind it

struct Attempt {
    bool drawn = false;
    bool go_on = false;  // another interpreter may do better
    std::string reason;
};

Attempt judge(const std::string& python, const ProgramRun& run) {
    if (run.not_started != 0)
        return {.go_on = true,
                .reason = fmt::format("cannot run {} ({}): install python3-matplotlib", python,
                                      std::generic_category().message(run.not_started))};
    if (WIFSIGNALED(run.status))
        return {.reason = fmt::format("{} was ended by signal {}", python, WTERMSIG(run.status))};
    const int code = WIFEXITED(run.status) ? WEXITSTATUS(run.status) : -1;
    if (code == 0) return {.drawn = true, .reason = {}};
    if (code == kNoMatplotlib)
        return {.go_on = true, .reason = fmt::format("{} has no matplotlib: install python3-matplotlib", python)};
    const std::string words =
        last_line(run.err.empty() ? run.out : run.err);  // an exception's message ends its traceback
    return {.go_on = code == kNoProgram,
            .reason = fmt::format("{} failed with {}{}", python, code, words.empty() ? words : ": " + words)};
}

// PYTHON - JSON, with the script as its input.
Attempt run_script(const std::string& python, const fs::path& json) {
    try {
        return judge(python, run_program({python, "-", json.string()}, embedded_files().at("tools/plot.py")));
    } catch (const std::system_error& error) {
        return {.reason = error.what()};
    }
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
