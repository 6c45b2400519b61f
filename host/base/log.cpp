#include "host/base/log.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>

namespace raya {
namespace {

std::mutex output_mutex;  // needed because the progress bar prints from its own thread
bool status_shown = false;

void write_stderr(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

std::atomic<int> current_level = kDefaultVerbosity;

}  // namespace

std::string printable(std::string_view text) {
    std::string escaped;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const auto c = static_cast<unsigned char>(text[at]);
        // The control characters U+0080..U+009F, which some terminals interpret too, are C2 80..C2 9F in UTF-8.
        const bool c1_control = c == 0xC2 && at + 1 < text.size() && static_cast<unsigned char>(text[at + 1]) < 0xA0;
        if ((c < ' ' && c != '\n' && c != '\t') || c == 0x7F || c1_control)
            escaped += fmt::format("\\x{:02x}", c1_control ? static_cast<unsigned char>(text[++at]) : c);
        else
            escaped += text[at];
    }
    return escaped;
}

void print_log(std::string_view text) {
    const std::lock_guard lock(output_mutex);
    write_stderr((status_shown ? "\r\033[K" : "") + printable(text));
    status_shown = false;
}

void show_status(std::string_view line) {
    const std::lock_guard lock(output_mutex);
    write_stderr("\r\033[K" + printable(line));
    status_shown = true;
}

void clear_status() {
    const std::lock_guard lock(output_mutex);
    if (status_shown) write_stderr("\r\033[K");
    status_shown = false;
}

void set_verbosity(int level) { current_level = std::clamp(level, kErrorsOnly, kDetailed); }

int verbosity() { return current_level; }

bool shows_progress() { return !is_quiet() && ::isatty(STDERR_FILENO) != 0; }

void log_message(int level, std::string_view text) {
    if (verbosity() < level) return;
    std::string lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        lines += fmt::format("raya: {}\n", text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    print_log(lines);
}

void warn(std::string_view text) {
    if (verbosity() > kErrorsOnly) print_log(fmt::format("raya: {}\n", text));
}

std::string progress_line(const std::string& stage, double fraction, double seconds) {
    constexpr int kWidth = 40;              // characters of the bar
    constexpr double kMinFraction = 0.001;  // minimum completed fraction for an estimate of the remaining time
    if (fraction < kMinFraction) return fmt::format("{} ... {:.0f} s", stage, seconds);
    const int filled = static_cast<int>(fraction * kWidth);
    return fmt::format("[{}{}] {:3.0f} %  {:.0f} s left", std::string(filled, '#'), std::string(kWidth - filled, '.'),
                       std::min(99.0, std::floor(100 * fraction)), seconds / fraction - seconds);
}

std::jthread announce_compiling(const std::string& device) {
    if (is_quiet()) return {};
    return std::jthread([device](const std::stop_token& end) {
        std::mutex mutex;
        std::condition_variable_any ended;
        std::unique_lock lock(mutex);
        const Clock::time_point began = Clock::now();
        const auto never = [] { return false; };
        ended.wait_for(lock, end, std::chrono::seconds(1), never);
        if (end.stop_requested()) return;
        print_log(fmt::format("raya: compiling kernels for {} (first run only) ...\n", device));
        ended.wait(lock, end, never);
        print_log(fmt::format("raya: compiling kernels took {:.1f} s\n", seconds_since(began)));
    });
}

ProgressBar::ProgressBar(bool wanted, const std::string& name) : stage_name_(name) {
    if (wanted && shows_progress())
        draw_thread_ = std::jthread([this](const std::stop_token& end) { draw_until(end); });
}

void ProgressBar::stage(const std::string& name) {
    const std::lock_guard lock(mutex_);
    stage_name_ = name;
    stage_began_ = Clock::now();
    fraction_ = 0;
}

void ProgressBar::update(double fraction) {
    const std::lock_guard lock(mutex_);
    fraction_ = std::max(fraction_, std::min(fraction, 1.0));
}

void ProgressBar::draw_until(const std::stop_token& end) {
    using namespace std::chrono_literals;
    std::condition_variable_any ended;
    std::unique_lock lock(mutex_);
    for (auto pause = 700ms; !end.stop_requested(); pause = 200ms) {
        ended.wait_for(lock, end, pause, [] { return false; });
        if (!end.stop_requested()) show_status(progress_line(stage_name_, fraction_, seconds_since(stage_began_)));
    }
    clear_status();
}

}  // namespace raya
