// Makes the parser of all commands inside the test process.
#pragma once
#include <CLI/CLI.hpp>
#include <memory>

#include "host/cli/commands.hpp"
#include "host/ranks/ranks.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {

inline std::shared_ptr<CLI::App> make_full_parser() { return make_program(Ranks::single(), "test"); }

/// Calls `each(command, path)` for `command` and all its subcommands at any depth, parents first, except `study`, whose
/// options Python parses. A path is, for example, {"generate", "balls"}.
template <class Each>
void for_each_command(CLI::App& command, const Each& each, const Arguments& path = {}) {
    each(command, path);
    for (CLI::App* subcommand : command.get_subcommands({})) {
        Arguments subcommand_path = path;
        subcommand_path.push_back(subcommand->get_name());
        if (subcommand->get_name() != "study") for_each_command(*subcommand, each, subcommand_path);
    }
}

inline Arguments operator+(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

}  // namespace raya
