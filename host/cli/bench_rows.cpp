#include "host/cli/bench_rows.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>

#include "host/cl/device_peak.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "host/image/image.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/ring/ring_work.hpp"
#include "host/ring/schedule.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

std::string array_text(const RingSettings& s) {
    std::string text = fmt::format("{} PEs, {}, {} bounces", s.mapping.pes, mapping_text(s.mapping), s.bounces);
    if (s.mapping.kind == RAYA_FOLD_BLOCK) text += ", fold block";
    if (s.sampling == Sampling::kCorners) text += ", corners";
    if (s.dynamic) text += ", " + dynamic_text(*s.dynamic);
    return text + ", accel " + accel_text(s.accel);
}

BenchMeasurement said_of(const std::string& kernel, const Scene& scene, const RingSettings& settings,
                         const std::string& array) {
    return {.kernel = kernel,
            .scene = scene.name,
            .size = fmt::format("{}x{}", settings.mapping.width, settings.mapping.height),
            .array = array,
            .format = format_name(settings.format),
            .hash = {}};
}

// What a renderer's first image says, and how to render more of them: `seconds(result)` is what is measured of one.
template <class Renderer, class Seconds>
BenchRow row_of(BenchMeasurement said, const NumberFormat& format, std::shared_ptr<Renderer> renderer,
                const EventCounts& (*events)(const decltype(renderer->render())&), Seconds seconds,
                std::optional<KernelWork> (*work)(const RingSettings&, const decltype(renderer->render())&) = nullptr,
                const RingSettings& settings = {}) {
    const auto first = renderer->render();
    said.lanes = first.lanes;
    said.group_size = first.group_size;
    said.rays = ray_count(events(first));
    said.hash = pixel_hash(first.image);
    said.build_options = first.build_options;
    return {.format = format,
            .said = std::move(said),
            .events = events(first),
            .build_s = first.build_s,
            .tuned = first.tuned,
            .image_s = [renderer, seconds] { return seconds(renderer->render()); },
            .work = work != nullptr ? work(settings, first) : std::nullopt};
}

const EventCounts& events_of_ring(const RingResult& r) { return r.all.events; }
const EventCounts& events_of_torus(const TorusResult& r) { return r.events; }

std::optional<KernelWork> trace_work(const RingSettings& settings, const RingResult& result) {
    return ring_kernel_work(settings, result).front();
}

TorusSettings torus_of(const RingSettings& s) {
    TorusSettings t = usual_torus({s.mapping.width, s.mapping.height});
    t.bounces = s.bounces;
    t.format = s.format;
    t.sampling = s.sampling;
    t.kernels = s.kernels;
    return t;
}

// Mean seconds of one call, of as many as take 20 ms together: of shorter ones, clock and launch would count.
double sample_seconds(const std::function<double()>& seconds) {
    constexpr double kLeastSeconds = 0.02;
    double sum = 0;
    int calls = 0;
    while (sum < kLeastSeconds) {
        sum += seconds();
        ++calls;
    }
    return sum / calls;
}

}  // namespace

BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes) {
    settings.format = format;
    settings.kernels.lanes = lanes;
    return row_of(said_of("trace", scene, settings, array_text(settings)), format,
                  std::make_shared<RingRenderer>(session, scene, settings), events_of_ring, trace_seconds, trace_work,
                  settings);
}

BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& way) {
    RingSettings s = settings;
    s.format = format;
    if (way == "torus") {
        const TorusSettings t = torus_of(s);
        const std::string array = fmt::format("4x4x4 nodes, torus3d, 4x4x4 voxels, {} bounces", t.bounces);
        return row_of(said_of("torus", scene, s, array), format, std::make_shared<TorusRenderer>(session, scene, t),
                      events_of_torus, [](const TorusResult& r) { return r.render_s; });
    }
    if (way != "none" && way != "grid" && way != "bvh")
        throw UserError(fmt::format("--ways {}: must be none, grid, bvh or torus", way));
    s.accel = parse_accel(way);
    return row_of(said_of("render, " + way, scene, s, array_text(s)), format,
                  std::make_shared<RingRenderer>(session, scene, s), events_of_ring,
                  [](const RingResult& r) { return r.render_s; });
}

const BenchRow& first_of_format(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) { return r.format == row.format; });
}

void check_rows(const std::vector<BenchRow>& rows) {
    for (const BenchRow& row : rows) {
        if (row.flushed) continue;
        const BenchRow& first = first_of_format(rows, row);
        const bool same_counts = row.said.kernel != first.said.kernel || row.events == first.events;
        if (row.said.hash == first.said.hash && row.said.rays == first.said.rays && same_counts) continue;
        throw DeviceError(fmt::format(
            "{}: {}, {} lanes gives another image than {}, {} lanes: {} and {}; the device or its compiler is wrong",
            row.said.format, row.said.kernel, row.said.lanes, first.said.kernel, first.said.lanes, row.said.hash,
            first.said.hash));
    }
}

void take_samples(std::vector<BenchRow>& rows, int samples) {
    for (int i = 0; i < samples; ++i)
        for (BenchRow& row : rows) row.seconds.push_back(sample_seconds(row.image_s));
    for (BenchRow& row : rows) std::sort(row.seconds.begin(), row.seconds.end());
}

void add_rooflines(BenchReport& report, const std::vector<BenchRow>& rows, const cl::Device& device) {
    std::map<std::pair<std::string, std::uint32_t>, DevicePeak> peaks;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].work) continue;
        BenchMeasurement& said = report.rows[i];
        try {
            const auto key = std::pair(said.format, said.lanes);
            if (!peaks.contains(key)) peaks[key] = device_peak(device, rows[i].format, said.lanes);
            const LabelSummary best{.label = rows[i].work->label,
                                    .kind = "kernel",
                                    .total_ns = static_cast<std::uint64_t>(said.best_s * 1e9)};
            said.roofline = roofline(peaks[key], {*rows[i].work}, {best});
        } catch (const DeviceError& error) {  // the rates stand
            said.roofline.emplace().lacking = error.what();
        }
    }
}

BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device) {
    BenchReport report{.raya = raya_version(),
                       .device = device.name,
                       .platform = device.platform,
                       .version = device.version,
                       .driver = device.driver,
                       .rows = {}};
    for (const BenchRow& row : rows) {
        report.rows.push_back(row.said);
        if (row.seconds.empty()) continue;
        report.rows.back().best_s = row.best();
        report.rows.back().median_s = row.median();
        report.rows.back().samples = static_cast<int>(row.seconds.size());
    }
    return report;
}

}  // namespace raya
