// Measurements of `raya bench`: rows of renders whose images are compared before they are timed, and kernel builds.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/opencl.hpp"
#include "host/model/number_format.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/ring_result.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/torus_plan.hpp"

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

/// Returns the first row with the format of `row`. Its image is the reference for the image of `row`, and its time is
/// the base of the speed-up of `row`.
const BenchRow& first_row_of_format(const std::vector<BenchRow>& rows, const BenchRow& row);

/// Prepares a row that measures the trace kernel's time on the device.
BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes);

/// Prepares a row that measures whole renders by the host's clock, from the packed scene to the image. `variant`: none,
/// grid or bvh for the ring machine of `settings` with that --accel; torus for 4 x 4 x 4 nodes without a memory limit.
/// Throws UserError for another variant.
BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& variant);

/// Returns the settings of a torus of 4 x 4 x 4 nodes without a memory limit with the size, bounces, format, sampling
/// and kernels of a ring.
TorusSettings torus_settings_of(const RingSettings& ring);

/// Throws DeviceError if rows of the same format differ in image or number of rays, or if rows of the same format and
/// kernel differ in event counts.
void check_rows(const std::vector<BenchRow>& rows);

/// Takes `samples` time samples of each row. For a sample, the row renders images for at least 20 ms; the sample is the
/// mean time of an image. Samples of different rows alternate, so that other programs disturb all rows equally.
void take_samples(std::vector<BenchRow>& rows, std::uint32_t samples);

/// Measures the device's peak for each format and number of lanes, and adds to `report` the roofline of each row that
/// measures a single kernel, from its best sample. If a peak cannot be measured, the report contains the reason.
void add_rooflines(BenchReport& report, const std::vector<BenchRow>& rows, const cl::Device& device);

/// Returns the rows as a report. The report has times only after take_samples().
BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device);

/// Renders the scene once for each pair of a format and a variant (none, grid, bvh, packets or torus). Returns the
/// build time and the time of the first launch of each kernel. A unique build option bypasses the driver's cache. If
/// the first variant is a ring machine without dynamic mapping, also renders the scene on this machine with each of the
/// two anti-aliasing methods. Throws DeviceError, and UserError for an unknown variant.
std::vector<BenchBuild> bench_builds(Session& session, const Scene& scene, RingSettings settings,
                                     const std::vector<NumberFormat>& formats,
                                     const std::vector<std::string>& variants);

}  // namespace raya
