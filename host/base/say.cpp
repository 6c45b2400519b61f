#include "host/base/say.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>

namespace raya {
namespace {

std::mutex speaking;  // of the bar's thread and the command's
bool status_shown = false;

void speak(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

std::atomic<int> asked_for = kUsual;

}  // namespace

std::string printable(std::string_view text) {
    std::string all;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const auto c = static_cast<unsigned char>(text[at]);
        // UTF-8 has U+0080..U+009F, which some terminals obey too, as C2 80..C2 9F.
        const bool obeyed = c == 0xC2 && at + 1 < text.size() && static_cast<unsigned char>(text[at + 1]) < 0xA0;
        if ((c < ' ' && c != '\n' && c != '\t') || c == 0x7F || obeyed)
            all += fmt::format("\\x{:02x}", obeyed ? static_cast<unsigned char>(text[++at]) : c);
        else
            all += text[at];
    }
    return all;
}

void say(std::string_view text) {
    const std::lock_guard lock(speaking);
    speak((status_shown ? "\r\033[K" : "") + printable(text));
    status_shown = false;
}

void show_status(std::string_view line) {
    const std::lock_guard lock(speaking);
    speak("\r\033[K" + printable(line));
    status_shown = true;
}

void clear_status() {
    const std::lock_guard lock(speaking);
    if (status_shown) speak("\r\033[K");
    status_shown = false;
}

void set_verbosity(int level) { asked_for = std::clamp(level, kSilent, kDetailed); }

int verbosity() { return asked_for; }

bool shows_progress() { return !is_quiet() && ::isatty(STDERR_FILENO) != 0; }

void tell(int level, std::string_view text) {
    if (verbosity() < level) return;
    std::string lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        lines += fmt::format("raya: {}\n", text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    say(lines);
}

void warn(std::string_view text) {
    if (verbosity() > kSilent) say(fmt::format("raya: {}\n", text));
}

}  // namespace raya
