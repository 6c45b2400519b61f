// The rows of `raya bench`: renderers that are ready, checked before they are timed, and what is printed of them.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/report/bench_report.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// One row: a renderer that has rendered once, so that its kernels are built, and what was measured with it.
struct BenchRow {
    NumberFormat format;
    BenchMeasurement said{};  // before take_samples() all but the times
    EventCounts events{};     // of the first image
    double build_s = 0;
    std::string tuned{};                // where lanes and group come from (host/cl/tuned.hpp)
    bool flushed = false;               // its kernel takes denormal numbers for 0, and may so make another image
    std::function<double()> image_s{};  // renders one more image: how long it took
    std::optional<KernelWork> work{};   // of one image, where the row is one kernel's
};

/// The trace kernel's time on the device.
BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes);

/// Time of whole renders on the host, from packed scene to image. `variant`: none, grid or bvh, the ring machine of
/// `settings` with that --accel; torus, 4 x 4 x 4 nodes without a memory limit. UserError for another one.
BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& variant);

/// DeviceError where rows of one format differ in image or rays, or rows of one kernel in what was counted.
void check_rows(const std::vector<BenchRow>& rows);

/// `samples` samples of each row, of 20 ms or more. The rows take turns, so that a disturbance from outside hits all of
/// them alike.
void take_samples(std::vector<BenchRow>& rows, std::uint32_t samples);

/// Each row's rates, times, speed-up and slow-down.
void print_rows(const std::vector<BenchRow>& rows);

/// Operations a second of the number layer in each format, measured now. DeviceError.
void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples);

/// What rows that leave lanes and group open have taken, where it was tuned.
void print_tuned(const std::vector<BenchRow>& rows);

/// Each row beside the one that takes denormal numbers for 0.
void print_denormals(const std::vector<BenchRow>& rows);

/// Holds each kernel's best sample against the device's peak, measured now for each format and width of lanes. What the
/// device cannot measure is said in the row.
void add_rooflines(BenchReport& report, const std::vector<BenchRow>& rows, const cl::Device& device);

/// The rows as they stand in a report; before take_samples() without times.
BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device);

}  // namespace raya
