#include "host/files/say.hpp"

#include <cstdio>
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

}  // namespace

void say(std::string_view text) {
    const std::lock_guard lock(speaking);
    speak((status_shown ? "\r\033[K" : "") + std::string(text));
    status_shown = false;
}

void show_status(std::string_view line) {
    const std::lock_guard lock(speaking);
    speak("\r\033[K" + std::string(line));
    status_shown = true;
}

void clear_status() {
    const std::lock_guard lock(speaking);
    if (status_shown) speak("\r\033[K");
    status_shown = false;
}

}  // namespace raya
