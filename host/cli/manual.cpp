// raya manual and raya completion: the texts of --help, as manual pages and as what completes words in a shell.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "host/base/whole_file.hpp"
#include "host/cli/command_text.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/completion.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/nearest.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

struct ManualCommand {
    std::string command, folder;
};

void print_page(const std::vector<ManPage>& pages, const std::string& command) {
    const std::string name = command.empty() ? pages.front().name : pages.front().name + '-' + command;
    std::vector<std::string> known;
    for (const ManPage& page : pages) {
        if (page.name == name) return fmt::print("{}", page.text);
        if (page.name != pages.front().name) known.push_back(page.name.substr(pages.front().name.size() + 1));
    }
    throw UserError(
        fmt::format("no command {}{}; there are {}", command, did_you_mean(command, known), fmt::join(known, ", ")));
}

void run_manual(const CLI::App& program, const ManualCommand& command) {
    const std::vector<ManPage> pages = man_pages(command_text(program), name_and_version());
    if (command.folder.empty()) return print_page(pages, command.command);
    if (!command.command.empty()) throw UserError("-o DIR writes all pages: leave the command out");
    for (const ManPage& page : pages) check_writable(std::filesystem::path(command.folder) / (page.name + ".1"));
    for (const ManPage& page : pages)
        write_whole_file(std::filesystem::path(command.folder) / (page.name + ".1"), page.text);
}

struct CompletionCommand {
    std::string shell, file;
};

void run_completion(const CLI::App& program, const CompletionCommand& command) {
    const std::vector<std::string>& shells = completed_shells();
    if (std::find(shells.begin(), shells.end(), command.shell) == shells.end())
        throw UserError(fmt::format("{}: must be {}", command.shell, fmt::join(shells, ", ")));
    const std::string script = completion_script(command_text(program), command.shell);
    if (command.file.empty()) return fmt::print("{}", script);
    write_whole_file(command.file, script);
}

}  // namespace

void add_manual_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("manual", "Print a manual page, to be read by: raya manual COMMAND | man -l -");
    add_examples(*command, {{"raya manual render | man -l -", "The page of a command, as man shows it"},
                            {"mkdir -p man1 && raya manual -o man1",
                             "All pages as files: man1/raya.1, man1/raya-render.1 and so on"}});
    const auto options = std::make_shared<ManualCommand>();
    const OptionGroup group(*command, kFiles);
    add_value(*command, "COMMAND", options->command, "Whose page; default: the one of raya, which names the others")
        ->type_name("COMMAND");
    add_file(*command, FileUse::kWrittenFolder, "-o,--output", options->folder, "DIR",
             "Write all pages into this folder, raya.1, raya-render.1 and so on");
    command->callback([options, &program] { run_manual(program, *options); });
}

void add_completion_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "completion",
        "Print what completes commands, options and values in a shell; in bash: source <(raya completion bash)");
    add_examples(*command,
                 {{"source <(raya completion bash)", "Commands and options complete in this bash from now on"},
                  {"raya completion zsh -o _raya", "A file for a folder of zsh's $fpath"}});
    const auto options = std::make_shared<CompletionCommand>();
    const OptionGroup group(*command, kFiles);
    add_value(*command, "SHELL", options->shell, "The shell: bash, zsh or fish")
        ->required()
        ->type_name("bash|zsh|fish");
    add_file(*command, FileUse::kWritten, "-o,--output", options->file, "FILE", "Write it to a file");
    command->callback([options, &program] { run_completion(program, *options); });
}

}  // namespace raya
