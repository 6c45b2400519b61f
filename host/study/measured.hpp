// What this machine takes for the same image: measured, not modelled.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/number_format.hpp"
#include "host/study/scenes.hpp"

namespace raya {

struct Measured {
    double min_ms = 0, median_ms = 0, max_ms = 0;
    int runs = 0;
};

/// The least, the median and the largest of what was measured, seconds; one at least.
Measured measured_of(std::vector<double> seconds);

/// Mean seconds of one call, of as many as take 20 ms together: what lasts less, clock and launch would count in.
double sample_seconds(const std::function<double()>& seconds);

/// Of the seconds that up to `runs` calls tell, one at least; no further call once `enough_s` seconds of them are told.
Measured measure(int runs, double enough_s, const std::function<double()>& seconds);

/// The same after a call that does not count: it warms caches and driver up.
Measured measure_warm(int runs, double enough_s, const std::function<double()>& seconds);

/// The double-precision reference on one thread; up to three runs, after a small one that does not count.
Measured measure_reference(const LabelledScene& scene, std::uint32_t size);

/// The kernels on the session's device, in a format; their time alone, up to five runs, after
/// one that does not count.
Measured measure_device(Session& session, const LabelledScene& scene, std::uint32_t size, const NumberFormat& format);

}  // namespace raya
