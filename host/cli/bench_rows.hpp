// The rows of `raya bench`: prepared renderers, their checks, samples and tables.
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

/// One row: a renderer that has rendered once, so that its kernels are built, and its measurement.
struct BenchRow {
    NumberFormat format;
    BenchMeasurement result{};  // without times before take_samples()
    EventCounts events{};       // of the first image
    double build_s = 0;
    std::string tuned{};                // source of lanes and group (host/cl/tuned.hpp)
    bool flushed = false;               // its kernel flushes denormal numbers to 0, which may change the image
    std::function<double()> image_s{};  // renders one more image; returns its seconds
    std::optional<KernelWork> work{};   // of one image, if the row measures a single kernel
};

/// Measures the trace kernel's time on the device.
BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes);

/// Measures the host's time of whole renders, from packed scene to image. `variant`: none, grid or bvh for the ring
/// machine of `settings` with that --accel; torus for 4 x 4 x 4 nodes without a memory limit. UserError for another.
BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& variant);

/// Throws DeviceError if rows of a format differ in image or rays, or rows of a kernel in event counts.
void check_rows(const std::vector<BenchRow>& rows);

/// Takes `samples` samples of each row, of 20 ms or more each. The rows alternate, so that a disturbance of the machine
/// affects all of them.
void take_samples(std::vector<BenchRow>& rows, std::uint32_t samples);

/// Prints each row's rates, times, speed-up and slow-down.
void print_rows(const std::vector<BenchRow>& rows);

/// Measures and prints the number layer's operations per second in each format. DeviceError.
void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples);

/// Prints the files of raya tune that the rows used.
void print_tuned(const std::vector<BenchRow>& rows);

/// Prints each row next to the row that flushes denormal numbers to 0.
void print_denormals(const std::vector<BenchRow>& rows);

/// Compares each kernel's best sample with the device's peak, which it measures for each format and number of lanes. A
/// row whose peak cannot be measured gets the reason.
void add_rooflines(BenchReport& report, const std::vector<BenchRow>& rows, const cl::Device& device);

/// The rows as a report; without times before take_samples().
BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device);

}  // namespace raya
