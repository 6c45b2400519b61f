// What is said to a person on stderr: where nobody listens, because it is closed or full, it is lost and nothing else.
#pragma once
#include <string>
#include <string_view>

namespace raya {

/// `text` with "\x1b" for each control character but \n and \t, so that a file's name cannot steer the terminal. For
/// stdout; what is said on stderr passes through it.
std::string printable(std::string_view text);

/// Says `text`, whole lines, in place of a status line that is shown.
void say(std::string_view text);

/// Shows `line` on a terminal, in place of what is shown: without a line's end, until something is said or the status
/// cleared.
void show_status(std::string_view line);
void clear_status();

}  // namespace raya
