// Shell completion of commands, options and values.
#pragma once
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// Returns the supported shells: "bash", "zsh", "fish".
const std::vector<std::string>& completed_shells();

/// Returns the completion script of a shell. The script contains all commands and options and does not run raya. Throws
/// std::logic_error for an unknown shell.
std::string completion_script(const CommandText& program, const std::string& shell);

std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

/// Returns the text in single quotes, for bash and zsh. The text `it's` becomes `'it'\''s'`.
std::string shell_quoted(const std::string& text);

/// Returns the clauses of a shell's `case` statement: one body for each command path. Paths with equal bodies share
/// one clause: "'raya generate balls'|'raya generate gears')".
std::string shell_cases(const std::vector<std::pair<std::string, std::string>>& paths_and_bodies);

}  // namespace raya
