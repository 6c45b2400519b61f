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

std::string progress_line(const std::string& stage, const std::optional<StageProgress>& progress, double seconds) {
    constexpr int kWidth = 40;              // characters of the bar
    constexpr double kMinFraction = 0.001;  // minimum completed fraction for an estimate of the remaining time
    const double fraction = progress ? progress->fraction : 0;
    if (fraction < kMinFraction) return fmt::format("{} ... {:.0f} s", stage, seconds);
    const int filled = static_cast<int>(fraction * kWidth);
    const double remaining_s = progress->seconds / fraction - seconds;
    return fmt::format(
        "[{}{}] {:3.0f} %  {}", std::string(filled, '#'), std::string(kWidth - filled, '.'),
        std::min(99.0, std::floor(100 * fraction)),
        remaining_s > 0 ? fmt::format("{:.0f} s left", remaining_s) : fmt::format("{:.0f} s so far", seconds));
}

std::jthread announce_compiling(const std::string& device, std::chrono::milliseconds patience) {
    if (is_quiet()) return {};
    return std::jthread([device, patience](const std::stop_token& end) {
        using namespace std::chrono;
        std::mutex mutex;
        std::condition_variable_any ended;
        std::unique_lock lock(mutex);
        const auto began = steady_clock::now();
        const auto never = [] { return false; };
        ended.wait_for(lock, end, 1s, never);
        if (end.stop_requested()) return;
        print_log(fmt::format("raya: compiling kernels for {} (first run only) ...\n", device));
        if (ended.wait_for(lock, end, patience, never); !end.stop_requested())
            print_log(fmt::format(
                "raya: still compiling after {:.0f} s; remedy: fewer --lanes, or POCL_WORK_GROUP_METHOD=loops with "
                "PoCL; raya bench --build shows which kernel is slow, docs/porting.md explains why\n",
                duration<double>(steady_clock::now() - began).count()));
        ended.wait(lock, end, never);
        print_log(fmt::format("raya: compiling kernels took {:.1f} s\n",
                              duration<double>(steady_clock::now() - began).count()));
    });
}

ProgressBar::ProgressBar(bool wanted, const std::string& name) : stage_name_(name) {
    if (wanted && shows_progress()) draw_thread_ = std::thread([this] { draw_until_ended(); });
}

ProgressBar::~ProgressBar() {
    if (!active()) return;
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    end_.notify_one();
    draw_thread_.join();
}

void ProgressBar::stage(const std::string& name) {
    const std::lock_guard lock(mutex_);
    stage_name_ = name;
    stage_began_ = Clock::now();
    progress_.reset();
}

void ProgressBar::update(double fraction) {
    const std::lock_guard lock(mutex_);
    fraction = std::clamp(fraction, 0.0, 1.0);
    if (!progress_ || fraction > progress_->fraction) progress_ = {fraction, stage_seconds()};
}

double ProgressBar::stage_seconds() const { return seconds_since(stage_began_); }

void ProgressBar::draw_until_ended() {
    using namespace std::chrono_literals;
    std::unique_lock lock(mutex_);
    for (auto pause = 700ms; !end_.wait_for(lock, pause, [this] { return ended_; }); pause = 200ms)
        show_status(progress_line(stage_name_, progress_, stage_seconds()));
    clear_status();
}

}  // namespace raya
