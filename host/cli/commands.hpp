// The commands of raya. Each file of this folder adds one to the parser and runs it; nothing else knows them.
#pragma once
#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace raya {

class Ranks;

/// Thrown by a command that has done its work, where what it was asked to check does not hold. What was found is
/// printed already.
struct CheckFailure {
    std::string summary{};  // printed on stderr unless empty
};

/// Parses the command line, runs the command and returns the exit code: 0 done, 2 for a mistake in options or input, 3
/// for trouble with the device, 4 for a check that failed, 1 for a fault of our own. Messages go to stderr. `build` is
/// what --version says beside the version.
int run_program(int argc, char** argv, const std::string& build);

/// The parser of all commands, whose callbacks run them; `ranks` outlive it.
std::shared_ptr<CLI::App> whole_program(Ranks& ranks, const std::string& build);

void add_render_command(CLI::App& program, Ranks& ranks);
void add_devices_command(CLI::App& program);
void add_explore_command(CLI::App& program);
void add_generate_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_bench_command(CLI::App& program);
void add_tune_command(CLI::App& program);
/// `run` takes the settings as JSON; default: this process becomes the Python that runs the laboratory (tools/lab).
void add_study_command(CLI::App& program, const std::function<void(const std::string&)>& run = {});
void add_page_command(CLI::App& program);
void add_verify_command(CLI::App& program);
void add_ping_command(CLI::App& program, Ranks& ranks);
void add_manual_command(CLI::App& program);
void add_completion_command(CLI::App& program);
void add_help_command(CLI::App& program);

}  // namespace raya
