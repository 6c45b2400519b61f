// Log messages on stderr and their verbosity. The state is global, like stderr.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace raya {

/// Returns `text` with each control character except \n and \t escaped ("\x1b"), so that the name of a file cannot send
/// commands to the terminal. For stdout; print_log() applies it itself.
std::string printable(std::string_view text);

/// Prints `text`, whole lines, on stderr. Clears the status line first.
void print_log(std::string_view text);

/// Shows a status line on a terminal, instead of the previous one, until something is printed or clear_status() is
/// called.
void show_status(std::string_view line);
void clear_status();

inline constexpr int kErrorsOnly = -2;       // no warnings either
inline constexpr int kQuiet = -1;            // no progress, no summary
inline constexpr int kDefaultVerbosity = 0;  // warnings, progress, summary
inline constexpr int kVerbose = 1;           // steps of the host too
inline constexpr int kDetailed = 2;          // kernel builds and times of the device too

/// Sets the level, clamped to kErrorsOnly..kDetailed.
void set_verbosity(int level);
int verbosity();

inline bool is_quiet() { return verbosity() <= kQuiet; }

/// Returns true if stderr is a terminal and the level allows progress output.
bool shows_progress();

/// Prints every line of `text` on stderr, each with the prefix "raya: ", if the verbosity is `level` or higher.
void log_message(int level, std::string_view text);

/// Prints "raya: TEXT" on stderr unless the verbosity is kErrorsOnly. For conditions that do not end the command.
void warn(std::string_view text);

}  // namespace raya
