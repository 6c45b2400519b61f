// Makes the parser and the CommandText of all commands inside the test process.
#pragma once
#include <CLI/CLI.hpp>
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

inline std::shared_ptr<CLI::App> make_full_parser() { return make_program(Ranks::single(), "test"); }
inline CommandText text_of_all_commands() { return command_text(*make_full_parser()); }

/// Calls `each(command, path)` for `command` and all its subcommands at any depth, parents first, except `study`, whose
/// options Python parses. A path is, for example, "raya generate balls".
template <class Each>
void for_each_command(const CommandText& command, const Each& each, const std::string& parent_path = "") {
    const std::string path = parent_path.empty() ? command.name : parent_path + ' ' + command.name;
    if (path == "raya study") return;
    each(command, path);
    for (const CommandText& subcommand : command.commands) for_each_command(subcommand, each, path);
}

}  // namespace raya
