// Shell completion of commands, options and values.
#pragma once
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// "bash", "zsh", "fish".
const std::vector<std::string>& completed_shells();

/// The completion script of a shell: all commands and options; it needs only the shell. Throws std::logic_error for an
/// unknown shell.
std::string completion_script(const CommandText& program, const std::string& shell);

std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

/// The text in single quotes, for bash and zsh: it's becomes 'it'\''s'.
std::string shell_quoted(const std::string& text);

/// The cases of a shell's `case` over command paths; paths with equal bodies share a case: "'raya generate
/// balls'|'raya generate gears')".
std::string shell_cases(const std::vector<std::pair<std::string, std::string>>& paths_and_bodies);

}  // namespace raya
