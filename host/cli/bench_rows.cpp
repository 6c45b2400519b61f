#include "cli/bench_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "error.hpp"
#include "image/image.hpp"
#include "report/render_report.hpp"
#include "ring/mapping.hpp"

namespace raya {
namespace {

// One sample is at least 20 ms of kernel time, so that the clock and the launch do not count.
double sample_seconds(RingRenderer& renderer) {
    constexpr double kLeastSeconds = 0.02;
    double seconds = 0;
    int images = 0;
    while (seconds < kLeastSeconds) {
        seconds += trace_seconds(renderer.render());
        ++images;
    }
    return seconds / images;
}

std::string array_text(const RingSettings& s) {
    std::string text = fmt::format("{} PEs, {}, {} bounces", s.mapping.pes, mapping_text(s.mapping), s.bounces);
    if (s.mapping.kind == RAYA_FOLD_BLOCK) text += ", fold block";
    if (s.sampling == Sampling::kCorners) text += ", corners";
    if (s.dynamic) text += ", " + dynamic_text(*s.dynamic);
    return text + ", accel " + accel_text(s.accel);
}

}  // namespace

BenchRow prepare_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                     std::uint32_t lanes) {
    settings.format = format;
    settings.kernels.lanes = lanes;
    BenchRow row{.format = format,
                 .renderer = std::make_unique<RingRenderer>(session, scene, settings),
                 .warm_up = {},
                 .hash = {},
                 .seconds = {}};
    row.warm_up = row.renderer->render();
    row.hash = pixel_hash(row.warm_up.image);
    return row;
}

const BenchRow& first_of_format(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) { return r.format == row.format; });
}

void check_rows(const std::vector<BenchRow>& rows) {
    for (const BenchRow& row : rows) {
        const BenchRow& first = first_of_format(rows, row);
        if (row.hash == first.hash && row.warm_up.all.events == first.warm_up.all.events) continue;
        throw DeviceError(
            fmt::format("{}: {} lanes give another image than {} lanes: {} and {}; the device or its compiler is wrong",
                        format_name(row.format), row.warm_up.lanes, first.warm_up.lanes, row.hash, first.hash));
    }
}

void take_samples(std::vector<BenchRow>& rows, int samples) {
    for (int i = 0; i < samples; ++i)
        for (BenchRow& row : rows) row.seconds.push_back(sample_seconds(*row.renderer));
    for (BenchRow& row : rows) std::sort(row.seconds.begin(), row.seconds.end());
}

BenchReport bench_report(const std::vector<BenchRow>& rows, const Scene& scene, const RingSettings& settings,
                         const DeviceInfo& device) {
    BenchReport report{.raya = RAYA_VERSION,
                       .device = device.name,
                       .platform = device.platform,
                       .version = device.version,
                       .driver = device.driver,
                       .rows = {}};
    for (const BenchRow& row : rows) {
        report.rows.push_back({.kernel = "trace",
                               .scene = scene.name,
                               .size = fmt::format("{}x{}", settings.mapping.width, settings.mapping.height),
                               .array = array_text(settings),
                               .format = format_name(row.format),
                               .lanes = row.warm_up.lanes,
                               .group_size = row.warm_up.group_size,
                               .rays = ray_count(row.warm_up.all.events),
                               .best_s = row.seconds.empty() ? 0 : row.best(),
                               .median_s = row.seconds.empty() ? 0 : row.median(),
                               .samples = static_cast<int>(row.seconds.size()),
                               .hash = row.hash,
                               .build_options = row.warm_up.build_options});
    }
    return report;
}

}  // namespace raya
