// raya manual and raya completion: write the help texts as manual pages and as shell completions.
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
    std::vector<std::string> known_names;
    for (const ManPage& page : pages) {
        if (page.name == name) return fmt::print("{}", page.text);
        if (page.name != pages.front().name) known_names.push_back(page.name.substr(pages.front().name.size() + 1));
    }
    throw UserError(fmt::format("no command {}{}; commands: {}", command, did_you_mean(command, known_names),
                                fmt::join(known_names, ", ")));
}

void run_manual(const CLI::App& program, const ManualCommand& command) {
    const std::vector<ManPage> pages = man_pages(command_text(program), name_and_version());
    if (command.folder.empty()) return print_page(pages, command.command);
    if (!command.command.empty()) throw UserError("-o DIR writes all pages: leave out the command");
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
        throw UserError(fmt::format("completion {}: must be {}", command.shell, fmt::join(shells, ", ")));
    const std::string script = completion_script(command_text(program), command.shell);
    if (command.file.empty()) return fmt::print("{}", script);
    write_whole_file(command.file, script);
}

}  // namespace

void add_manual_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("manual", "Print a manual page; to read it: raya manual COMMAND | man -l -");
    add_examples(*command,
                 {{"raya manual render | man -l -", "Read the page of a command"},
                  {"mkdir -p man1 && raya manual -o man1", "Write all pages: man1/raya.1, man1/raya-render.1, ..."}});
    const auto options = std::make_shared<ManualCommand>();
    const OptionGroup group(*command, kFiles);
    add_value(*command, "COMMAND", options->command,
              "Command whose page is printed; default: raya itself, whose page lists all commands")
        ->type_name("COMMAND");
    add_file(*command, FileUse::kWrittenFolder, "-o,--output", options->folder, "DIR",
             "Write all pages to this folder: raya.1, raya-render.1, ...");
    command->callback([options, &program] { run_manual(program, *options); });
}

void add_completion_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "completion",
        "Print a shell's completion script for commands, options and values; in bash: source <(raya completion bash)");
    add_examples(*command, {{"source <(raya completion bash)", "Enable completion in this bash"},
                            {"raya completion zsh -o _raya", "Write the file for a folder of zsh's $fpath"}});
    const auto options = std::make_shared<CompletionCommand>();
    const OptionGroup group(*command, kFiles);
    add_value(*command, "SHELL", options->shell, "The shell: bash, zsh or fish")
        ->required()
        ->type_name("bash|zsh|fish");
    add_file(*command, FileUse::kWritten, "-o,--output", options->file, "FILE", "Write the script to a file");
    command->callback([options, &program] { run_completion(program, *options); });
}

}  // namespace raya
