#include "host/base/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

namespace raya {
namespace {

constexpr std::size_t kUsual = 80, kLeast = 40, kMost = 120, kSane = 10'000;

/// 0: nothing that can be meant.
std::size_t named_width() {
    const char* const columns = std::getenv("COLUMNS");
    if (columns == nullptr) return 0;
    const std::string_view text = columns;
    std::size_t width = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
    const bool sane = error == std::errc{} && end == text.data() + text.size() && width <= kSane;
    return sane ? width : 0;
}

std::size_t terminal_width() {
    winsize size{};
    return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace

std::size_t text_width() {
    std::size_t width = named_width();
    if (width == 0) width = terminal_width();
    return width == 0 ? kUsual : std::clamp(width, kLeast, kMost);
}

}  // namespace raya
