// Makes the parser and the CommandText of all commands inside the test process.
#pragma once
#include <CLI/CLI.hpp>
#include <memory>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

inline std::shared_ptr<CLI::App> make_full_parser() { return make_program(Ranks::single(), "test"); }
inline CommandText text_of_all_commands() { return command_text(*make_full_parser()); }

}  // namespace raya
