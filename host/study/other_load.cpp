#include "host/study/other_load.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace raya {
namespace {

std::optional<ProcessorTime> time_now() {
    std::ifstream file("/proc/stat");
    std::string line;
    std::getline(file, line);
    return processor_time(line, static_cast<double>(::sysconf(_SC_CLK_TCK)));
}

double own_seconds() {
    double seconds = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage use{};
        ::getrusage(who, &use);
        for (const timeval& time : {use.ru_utime, use.ru_stime})
            seconds += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
    return seconds;
}

}  // namespace

// cpu user nice system idle iowait irq softirq steal; what guests had is among user's and nice's (proc(5)).
std::optional<ProcessorTime> processor_time(const std::string& stat, double ticks) {
    constexpr int kIdle = 3, kWaiting = 4, kFields = 8;
    std::istringstream words(stat);
    std::string name;
    words >> name;
    ProcessorTime time;
    for (int field = 0; field < kFields; ++field) {
        double value = 0;
        if (!(words >> value) || name != "cpu") return {};
        time.all_s += value / ticks;
        if (field != kIdle && field != kWaiting) time.busy_s += value / ticks;
    }
    return time;
}

OtherLoad::OtherLoad() : start_(time_now()), own_start_s_(own_seconds()) {}

std::optional<double> OtherLoad::share() const {
    const std::optional<ProcessorTime> now = time_now();
    if (!start_ || !now || now->all_s <= start_->all_s) return {};
    const double others = now->busy_s - start_->busy_s - (own_seconds() - own_start_s_);
    return std::clamp(others / (now->all_s - start_->all_s), 0.0, 1.0);
}

}  // namespace raya
