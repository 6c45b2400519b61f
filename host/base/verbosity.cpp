#include "host/base/verbosity.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>

#include "host/base/say.hpp"

namespace raya {
namespace {

std::atomic<int> asked_for = kUsual;

}  // namespace

void set_verbosity(int level) { asked_for = std::clamp(level, kSilent, kDetailed); }

int verbosity() { return asked_for; }

std::vector<std::string> verbosity_words() {
    const int level = verbosity();
    return std::vector<std::string>(static_cast<std::size_t>(std::abs(level)), level < 0 ? "--quiet" : "--verbose");
}

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
