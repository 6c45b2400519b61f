// Elapsed time, and the current date and time as text.
#pragma once
#include <chrono>
#include <ctime>
#include <string>

namespace raya {

using Clock = std::chrono::steady_clock;

/// Returns the time from `start` to now, in seconds.
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns the current time in UTC, formatted by std::strftime(`format`); empty if the text would have more than 63
/// characters.
inline std::string utc_text(const char* format) {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    char text[64];
    return {text, std::strftime(text, sizeof text, format, gmtime_r(&now, &parts))};
}

}  // namespace raya
