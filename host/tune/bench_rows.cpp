#include "host/tune/bench_rows.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "host/base/encoding.hpp"
#include "host/cl/measure.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/tune/tune.hpp"
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

// Renders one image and returns a row with the image's event counts. `seconds`: returns the measured seconds of a
// render. `size`: settings of a ring with the image size and number format of the row.
template <class Renderer, class Seconds>
BenchRow row_of(const std::string& kernel, const Scene& scene, const RingSettings& size, const std::string& array,
                std::shared_ptr<Renderer> renderer, const Seconds& seconds) {
    const RenderResult result = renderer->render();
    return {.format = size.format,
            .result = {.kernel = kernel,
                       .scene = scene.name,
                       .size = fmt::format("{}x{}", size.mapping.width, size.mapping.height),
                       .array = array,
                       .format = format_name(size.format),
                       .lanes = result.lanes,
                       .group_size = result.group_size,
                       .rays = ray_count(result.events),
                       .hash = pixel_hash(result.image),
                       .build_options = result.build_options},
            .events = result.events,
            .build_s = result.build_s,
            .tuned = result.tuned,
            .image_s = [renderer, seconds] { return seconds(renderer->render()); },
            .work = {}};
}

double render_seconds(const RenderResult& r) { return r.render_s; }

}  // namespace

TorusSettings torus_settings_of(const RingSettings& s) {
    TorusSettings t = default_torus({s.mapping.width, s.mapping.height});
    t.bounces = s.bounces;
    t.format = s.format;
    t.sampling = s.sampling;
    t.kernels = s.kernels;
    return t;
}

const BenchRow& first_row_of_format(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) { return r.format == row.format; });
}

BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes) {
    settings.format = format;
    settings.kernels.lanes = lanes;
    const auto renderer = std::make_shared<RingRenderer>(session, scene, settings);
    BenchRow row = row_of("trace", scene, settings, array_text(settings), renderer, trace_seconds);
    row.work = ring_kernel_work(settings, renderer->render()).front();
    return row;
}

BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& variant) {
    const bool packets = variant == "packets";
    const TuningKey key = Workload{packets ? "bvh" : variant, format}.key();
    RingSettings s = settings;
    s.format = format;
    if (key.torus) {
        const TorusSettings t = torus_settings_of(s);
        const std::string array = fmt::format("4x4x4 nodes, torus3d, 4x4x4 voxels, {} bounces", t.bounces);
        return row_of("torus", scene, s, array, std::make_shared<TorusRenderer>(session, scene, t), render_seconds);
    }
    s.accel = {.kind = static_cast<AccelKind>(key.accel)};
    if (packets) use_packets(s, s.mapping.kind != RAYA_TILES);
    if (packets && !s.packets)
        throw UserError(fmt::format(
            "--variants packets: needs --format fp32 and tiles that divide the image, not {} and {}x{} pixels",
            format_name(format), s.mapping.width, s.mapping.height));
    return row_of("render, " + variant, scene, s, array_text(s), std::make_shared<RingRenderer>(session, scene, s),
                  render_seconds);
}

void check_rows(const std::vector<BenchRow>& rows) {
    for (const BenchRow& row : rows) {
        const BenchRow& first = first_row_of_format(rows, row);
        const bool same_counts = row.result.kernel != first.result.kernel || row.events == first.events;
        if (row.result.hash == first.result.hash && row.result.rays == first.result.rays && same_counts) continue;
        throw DeviceError(fmt::format(
            "{}: {}, {} lanes: the image or its event counts differ from those of {}, {} lanes (image hashes {} and "
            "{}): the device or its compiler is wrong; run raya verify to find the error",
            row.result.format, row.result.kernel, row.result.lanes, first.result.kernel, first.result.lanes,
            row.result.hash, first.result.hash));
    }
}

void take_samples(std::vector<BenchRow>& rows, std::uint32_t samples) {
    std::vector<std::vector<double>> seconds(rows.size());
    for (std::uint32_t i = 0; i < samples; ++i)
        for (std::size_t r = 0; r < rows.size(); ++r) seconds[r].push_back(mean_seconds(rows[r].image_s));
    for (std::size_t r = 0; r < rows.size(); ++r) {
        std::ranges::sort(seconds[r]);
        rows[r].result.best_s = seconds[r].front();
        rows[r].result.median_s = seconds[r][samples / 2];
        rows[r].result.samples = static_cast<int>(samples);
    }
}

void add_rooflines(BenchReport& report, const std::vector<BenchRow>& rows, const cl::Device& device) {
    std::map<std::pair<std::string, std::uint32_t>, DevicePeak> peaks;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].work) continue;
        BenchMeasurement& measurement = report.rows[i];
        try {
            const auto key = std::pair(measurement.format, measurement.lanes);
            if (!peaks.contains(key)) peaks[key] = device_peak(device, rows[i].format, measurement.lanes);
            const LabelSummary best_sample{.label = rows[i].work->label,
                                           .kind = "kernel",
                                           .total_ns = static_cast<std::uint64_t>(measurement.best_s * 1e9)};
            measurement.roofline = roofline(peaks[key], {*rows[i].work}, {best_sample});
        } catch (const DeviceError& error) {  // not rethrown: the row's times are valid without a roofline
            measurement.roofline.emplace().unavailable = error.what();
        }
    }
}

BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device) {
    BenchReport report{.raya = raya_version(), .device = device};
    for (const BenchRow& row : rows) report.rows.push_back(row.result);
    return report;
}

std::vector<BenchBuild> bench_builds(Session& session, const Scene& scene, RingSettings settings,
                                     const std::vector<NumberFormat>& formats,
                                     const std::vector<std::string>& variants) {
    // Drivers cache kernels by source and options. No earlier build has this option, so the driver compiles anew.
    const std::string unique_option = fmt::format("-DRAYA_BUILT={}", Clock::now().time_since_epoch().count());
    settings.kernels.sources.more_options.push_back(unique_option);
    KernelBuilds recorded;
    session.observe(recorded);
    std::vector<BenchBuild> builds;
    for (const NumberFormat& format : formats) {
        for (const std::string& variant : variants) {
            RingSettings variant_settings = settings;
            std::uint32_t lanes = render_row(session, scene, variant_settings, format, variant).result.lanes;
            if (variant != "torus" && variant == variants.front() && !variant_settings.dynamic)
                for (const AntialiasMethod method : {AntialiasMethod::kFilter, AntialiasMethod::kSupersample}) {
                    variant_settings.antialias.method = method;
                    lanes = render_row(session, scene, variant_settings, format, variant).result.lanes;
                }
            for (const KernelBuild& build : recorded.all)
                builds.push_back({.kernel = build.name,
                                  .variant = variant,
                                  .format = format_name(format),
                                  .lanes = lanes,
                                  .build_s = build.build_s,
                                  .launch_s = build.launch_s,
                                  .build_options = replaced(build.options, " " + unique_option, "")});
            recorded.all.clear();
        }
    }
    session.ignore(recorded);
    return builds;
}

}  // namespace raya
