// The time of day, as files tell it.
#pragma once
#include <ctime>
#include <string>

namespace raya {

/// Now, by Coordinated Universal Time; `format` as std::strftime has it, 63 characters at most.
inline std::string utc_text(const char* format) {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    char text[64];
    return {text, std::strftime(text, sizeof text, format, gmtime_r(&now, &parts))};
}

}  // namespace raya
