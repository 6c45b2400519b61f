// raya study STUDY [SCENE...] -o DIR: starts the Python module raya.lab (tools/lab), which parses the arguments, runs
// studies, divides them into shards, merges shards and checks manifests.
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/module.hpp"
#include "host/cli/commands.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

// Returns the folder that contains the Python package raya, in the build folder or in the installation of `program`.
// Returns an empty path if neither contains the package.
fs::path package_folder(const fs::path& program) {
    std::error_code error;
    for (const fs::path& folder :
         {program.parent_path() / "python", program.parent_path().parent_path() / "lib/python3/dist-packages"})
        if (fs::is_directory(folder / "raya/lab", error)) return fs::canonical(folder);
    return {};
}

// Refuses a module folder in which other users can change files.
void check_module_folder(const fs::path& folder) {
    struct stat status {};
    ::stat(folder.c_str(), &status);
    const std::string why = unsafe_path_reason(folder / "raya", {::geteuid(), status.st_uid}, Sticky::kRefused);
    if (!why.empty()) throw UserError(fmt::format("refused to run '{}': {}; remedy: chmod go-w", folder.string(), why));
}

// Replaces the process with Python, which runs the module raya.lab with these arguments. Throws UserError on failure.
[[noreturn]] void start_study(std::vector<std::string> arguments) {
    const std::string python_variable = environment_value("RAYA_PYTHON");
    const std::string python = python_variable.empty() ? "/usr/bin/python3" : python_variable;
    const fs::path program = fs::read_symlink("/proc/self/exe"), folder = package_folder(program);
    if (folder.empty() && python_variable.empty())
        throw UserError(
            "study needs the Python module raya, and this program was built without it; remedy: tools/setup, then "
            "build again, or set RAYA_PYTHON to a Python that has the module");
    if (!folder.empty()) {
        check_module_folder(folder);
        const std::string path = environment_value("PYTHONPATH");
        ::setenv("PYTHONPATH", (folder.string() + (path.empty() ? "" : ":" + path)).c_str(), 1);
    }
    ::setenv("PYTHONSAFEPATH", "1", 1);  // Python imports no modules from the working folder
    ::setenv("RAYA_PROGRAM", program.c_str(), 1);
    // Until raya.lab handles signals, Ctrl-C ends Python without a traceback, but not before Python can unblock it.
    constexpr const char* kStart =
        "import runpy, signal; signal.getsignal(2) == signal.SIG_IGN or signal.signal(2, signal.SIG_DFL); "
        "signal.pthread_sigmask(signal.SIG_UNBLOCK, [2]); "
        "runpy.run_module('raya.lab', run_name='__main__', alter_sys=True)";
    sigset_t interruption;
    ::sigemptyset(&interruption);
    ::sigaddset(&interruption, SIGINT);
    ::sigprocmask(SIG_BLOCK, &interruption, nullptr);
    arguments.insert(arguments.begin(), {python, "-c", kStart});
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    ::execvp(python.c_str(), argv.data());
    throw UserError(
        fmt::format("study needs Python: cannot start {}: {}; remedy: sudo apt-get install python3, or "
                    "set RAYA_PYTHON to another Python",
                    python, std::generic_category().message(errno)));
}

}  // namespace

void add_study_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("study", "Run series of renders that test the papers' claims");
    command->prefix_command()->set_help_flag();  // Python parses the arguments
    command->callback([command] {
        std::vector<std::string> arguments = command->remaining();
        arguments.insert(arguments.end(), std::size_t(std::abs(verbosity())), verbosity() < 0 ? "-q" : "-v");
        start_study(std::move(arguments));
    });
}

}  // namespace raya
