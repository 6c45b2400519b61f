// The commands of raya. Each add_*_command() adds a command to the parser, with a callback that runs the command.
#pragma once
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace raya {

class Ranks;

/// Thrown by a command that ran to its end and found a failed check. The command has already printed the findings.
struct CheckFailure {
    std::string summary{};  // printed on stderr unless empty
};

/// Parses the command line, runs the command and returns the exit code: 0 success, 1 internal error, 2 bad option or
/// input, 3 device or driver failure, 4 failed check. Prints errors on stderr. `build`: a text that --version prints.
int run_program(int argc, char** argv, const std::string& build);

/// Makes the parser of all commands. `ranks` must outlive the parser.
std::shared_ptr<CLI::App> make_program(Ranks& ranks, const std::string& build);

void add_render_command(CLI::App& program, Ranks& ranks);
void add_devices_command(CLI::App& program);
void add_machines_command(CLI::App& program);
void add_explore_command(CLI::App& program);
void add_generate_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_bench_command(CLI::App& program);
void add_tune_command(CLI::App& program);
void add_study_command(CLI::App& program);
void add_page_command(CLI::App& program);
void add_verify_command(CLI::App& program);

}  // namespace raya
