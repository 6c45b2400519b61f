// Log messages and the status line on stderr, and the verbosity, which is global.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace raya {

/// Returns `text` with each control character except \n and \t escaped ("\x1b"), so that the name of a file cannot send
/// commands to the terminal. Call it for output to stdout; print_log() and show_status() call it themselves.
std::string printable(std::string_view text);

/// Erases the status line and prints `text`, which consists of whole lines, on stderr.
void print_log(std::string_view text);

/// Replaces the status line on stderr, which must be a terminal, by `line`. print_log(), clear_status() or the next
/// call erases the line.
void show_status(std::string_view line);
void clear_status();

// Levels of verbosity, and the messages that raya prints at each.
inline constexpr int kErrorsOnly = -2;       // errors
inline constexpr int kQuiet = -1;            // errors, warnings
inline constexpr int kDefaultVerbosity = 0;  // errors, warnings, progress, summary
inline constexpr int kVerbose = 1;           // also the steps of the host, with their times
inline constexpr int kDetailed = 2;          // also kernel builds, and times of device commands

/// Sets the level, clamped to kErrorsOnly..kDetailed.
void set_verbosity(int level);
int verbosity();

inline bool is_quiet() { return verbosity() <= kQuiet; }

/// Returns true if stderr is a terminal and the level allows progress output.
bool shows_progress();

/// Prints every line of `text` on stderr, each with the prefix "raya: ", if the verbosity is `level` or higher.
void log_message(int level, std::string_view text);

/// Prints "raya: TEXT" on stderr unless the verbosity is kErrorsOnly. For problems that do not end the command.
void warn(std::string_view text);

}  // namespace raya
