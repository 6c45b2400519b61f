// What is said to a person on stderr, beside results, and how much of it: as global as stderr.
#pragma once
#include <string>
#include <string_view>
#include <vector>

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

inline constexpr int kSilent = -2;   // nor warnings
inline constexpr int kQuiet = -1;    // no progress, no summary
inline constexpr int kUsual = 0;     //
inline constexpr int kVerbose = 1;   // what the host does
inline constexpr int kDetailed = 2;  // kernels' builds and the device's times too

/// kSilent..kDetailed; what lies beyond is the nearest of them.
void set_verbosity(int level);
int verbosity();

inline bool is_quiet() { return verbosity() <= kQuiet; }

/// Whether a person at a terminal may be shown how far a command has come.
bool shows_progress();

/// Says every line of `text` on stderr, "raya: " in front of each, at `level` and above.
void tell(int level, std::string_view text);

/// Says "raya: TEXT", of what a user should know although the command goes on, but where even that is not wanted.
void warn(std::string_view text);

}  // namespace raya
