// What the parser knows of commands and options, as plain text.
#pragma once
#include <CLI/CLI.hpp>

#include "host/cli/command_text.hpp"

namespace raya {

OptionText option_text(CLI::Option& option);

/// The program with all its commands, but for what help does not show. A word called COMMAND is one of those.
CommandText command_text(const CLI::App& program);

}  // namespace raya
