// What other programs took of this host's processors while something was measured: then its times are not its own.
#pragma once
#include <optional>
#include <string>

namespace raya {

/// Of all processors since the host was started.
struct ProcessorTime {
    double busy_s = 0, all_s = 0;
};

/// Of the first line of /proc/stat, in ticks of which a second has so many; empty for another text.
std::optional<ProcessorTime> processor_time(const std::string& stat, double ticks);

/// Share of the processors that others may have beside what is measured.
inline constexpr double kQuiet = 0.05;

class OtherLoad {
  public:
    /// Begins to look.
    OtherLoad();

    /// Share of all processors' time since then that neither this program had nor programs that it has run to their
    /// end, 0..1; empty where the system does not tell.
    std::optional<double> share() const;

  private:
    std::optional<ProcessorTime> start_;
    double own_start_s_;
};

}  // namespace raya
