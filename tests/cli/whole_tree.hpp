// The parser of all commands, in this process.
#pragma once
#include <CLI/CLI.hpp>
#include <memory>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

inline std::shared_ptr<CLI::App> parser_of_all() { return whole_program(Ranks::alone(), "test"); }
inline CommandText tree_of_all() { return command_text(*parser_of_all()); }

}  // namespace raya
