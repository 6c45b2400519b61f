// What completes commands, options and values in a shell.
#pragma once
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// "bash", "zsh", "fish".
const std::vector<std::string>& completed_shells();

/// The script for one of them, which names all commands and options and needs nothing but the shell. Throws
/// std::logic_error for another.
std::string completion_script(const CommandText& program, const std::string& shell);

// Those of each shell.
std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

/// 'text' as one word of a shell, bash's and zsh's: it's as 'it'\''s'.
std::string shell_quoted(const std::string& text);

/// Cases of a shell's `case` by a command's words, those with the same `body` together: "'raya generate
/// balls'|'raya generate gears')".
std::string shell_cases(const std::vector<std::pair<std::string, std::string>>& words_and_bodies);

}  // namespace raya
