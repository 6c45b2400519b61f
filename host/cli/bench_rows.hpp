// The rows of `raya bench`: renderers, checks of their images, time samples and tables.
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

/// A row of the table: a renderer and its measurement. The renderer has rendered one image, so its kernels are built.
struct BenchRow {
    NumberFormat format;
    BenchMeasurement result{};          // take_samples() adds the times
    EventCounts events{};               // event counts of one image
    double build_s = 0;                 // seconds that the kernel builds took
    std::string tuned{};                // source of the lanes and group size (host/cl/kernel_options.hpp)
    std::function<double()> image_s{};  // renders the image again; returns its seconds
    std::optional<KernelWork> work{};   // operations and bytes of the row's kernel; empty if it times several kernels
};

/// Prepares a row that measures the trace kernel's time on the device.
BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes);

/// Prepares a row that measures whole renders by the host's clock, from the packed scene to the image. `variant`: none,
/// grid or bvh for the ring machine of `settings` with that --accel; torus for 4 x 4 x 4 nodes without a memory limit.
/// Throws UserError for another variant.
BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& variant);

/// Throws DeviceError if rows of the same format differ in image or number of rays, or if rows of the same format and
/// kernel differ in event counts.
void check_rows(const std::vector<BenchRow>& rows);

/// Takes `samples` time samples of each row. For a sample, the row renders images for at least 20 ms; the sample is the
/// mean time of an image. Samples of different rows alternate, so that other programs disturb all rows equally.
void take_samples(std::vector<BenchRow>& rows, std::uint32_t samples);

/// Prints the rays per second, times, speed-up and slow-down of each row.
void print_rows(const std::vector<BenchRow>& rows);

/// Measures how often per second the device can execute each operation of the number layer, for each format. Prints the
/// best of `samples` samples. Throws DeviceError.
void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples);

/// Prints the names of the files of tuned values (raya tune) that the rows used.
void print_tuned(const std::vector<BenchRow>& rows);

/// Measures the device's peak for each format and number of lanes, and adds to `report` the roofline of each row that
/// measures a single kernel, from its best sample. If a peak cannot be measured, the report contains the reason.
void add_rooflines(BenchReport& report, const std::vector<BenchRow>& rows, const cl::Device& device);

/// Returns the rows as a report. The report has times only after take_samples().
BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device);

}  // namespace raya
