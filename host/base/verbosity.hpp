// How much is said beside results and errors: as global as stderr, where most of it is said.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace raya {

inline constexpr int kSilent = -2;   // nor warnings
inline constexpr int kQuiet = -1;    // no progress, no summary
inline constexpr int kUsual = 0;     //
inline constexpr int kVerbose = 1;   // what the host does
inline constexpr int kDetailed = 2;  // kernels' builds and the device's times too

/// kSilent..kDetailed; what lies beyond is the nearest of them.
void set_verbosity(int level);
int verbosity();

/// The options with which a process of this program's own says as much.
std::vector<std::string> verbosity_words();

inline bool is_quiet() { return verbosity() <= kQuiet; }

/// Whether a person at a terminal may be shown how far a command has come.
bool shows_progress();

/// Says every line of `text` on stderr, "raya: " in front of each, at `level` and above.
void tell(int level, std::string_view text);

/// Says "raya: TEXT", of what a user should know although the command goes on, but where even that is not wanted.
void warn(std::string_view text);

}  // namespace raya
