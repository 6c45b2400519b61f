// raya help COMMAND: prints the help that raya COMMAND --help prints.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/nearest.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse_failure.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

const CLI::App& subcommand_named(const CLI::App& command, const std::string& name) {
    for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
        if (subcommand->get_name() == name) return *subcommand;
    const std::vector<std::string> known_names = command_names(command);
    if (known_names.empty())
        throw UserError(
            fmt::format("help: {} has no command {}; see raya help {}", command.get_name(), name, command.get_name()));
    throw UserError(fmt::format("help: no command {}{}; commands: {}", name, did_you_mean(name, known_names),
                                fmt::join(known_names, ", ")));
}

void print_help(const CLI::App& program, const std::vector<std::string>& names) {
    const CLI::App* command = &program;
    std::string path = program.get_name();
    for (const std::string& name : names) {
        command = &subcommand_named(*command, name);
        path += ' ' + name;
    }
    fmt::print("{}", command->get_formatter()->make_help(command, path, CLI::AppFormatMode::Normal));
}

}  // namespace

void add_help_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("help", "Print the help of a command, or of raya itself");
    add_examples(*command, {{"raya help render", "Print the help of render, as raya render --help does"},
                            {"raya help generate balls", "Print the help of one generator"}});
    const auto names = std::make_shared<std::vector<std::string>>();
    add_value(*command, "COMMAND", *names, "The command, such as generate balls; default: raya itself")
        ->type_name("COMMAND");
    command->callback([names, &program] { print_help(program, *names); });
}

}  // namespace raya
