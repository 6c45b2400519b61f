// raya bench: measures rays per second on a device by kernel, lanes and format. Compares the images of all rows before
// it times the first row.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_options.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/model/number_format.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/render_report.hpp"
#include "host/report/table.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/ring/ring_result.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/tune/tune.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

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

// `raya bench --build`: measures the compile times of the kernels of each format and variant.


std::string array_text(const RingSettings& s) {
    std::string text = fmt::format("{} PEs, {}, {} bounces", s.mapping.pes, mapping_text(s.mapping), s.bounces);
    if (s.mapping.kind == RAYA_FOLD_BLOCK) text += ", fold block";
    if (s.sampling == Sampling::kCorners) text += ", corners";
    if (s.dynamic) text += ", " + dynamic_text(*s.dynamic);
    return text + ", accel " + accel_text(s.accel);
}

BenchMeasurement make_measurement(const std::string& kernel, const Scene& scene, const RingSettings& settings,
                                  const std::string& array) {
    return {.kernel = kernel,
            .scene = scene.name,
            .size = fmt::format("{}x{}", settings.mapping.width, settings.mapping.height),
            .array = array,
            .format = format_name(settings.format),
            .hash = {}};
}

// Renders one image and returns a row with the image's event counts. `seconds`: returns the measured seconds of a
// render.
template <class Renderer, class Seconds>
BenchRow row_of(BenchMeasurement measurement, const NumberFormat& format, std::shared_ptr<Renderer> renderer,
                const Seconds& seconds) {
    const RenderResult result = renderer->render();
    measurement.lanes = result.lanes;
    measurement.group_size = result.group_size;
    measurement.rays = ray_count(result.events);
    measurement.hash = pixel_hash(result.image);
    measurement.build_options = result.build_options;
    return {.format = format,
            .result = std::move(measurement),
            .events = result.events,
            .build_s = result.build_s,
            .tuned = result.tuned,
            .image_s = [renderer, seconds] { return seconds(renderer->render()); },
            .work = {}};
}

double render_seconds(const RenderResult& r) { return r.render_s; }

TorusSettings torus_settings_of(const RingSettings& s) {
    TorusSettings t = default_torus({s.mapping.width, s.mapping.height});
    t.bounces = s.bounces;
    t.format = s.format;
    t.sampling = s.sampling;
    t.kernels = s.kernels;
    return t;
}

// Returns the first row with the kernel and lanes of `row`. Its time is the base of the slow-down of `row`.
const BenchRow& first_row_of_kernel_and_lanes(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) {
        return r.result.kernel == row.result.kernel && r.result.lanes == row.result.lanes;
    });
}

// Returns the first row with the format of `row`. Its image is the reference for the image of `row`, and its time is
// the base of the speed-up of `row`.
const BenchRow& first_row_of_format(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) { return r.format == row.format; });
}


// Prepares a row that measures the trace kernel's time on the device.
BenchRow trace_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                   std::uint32_t lanes) {
    settings.format = format;
    settings.kernels.lanes = lanes;
    const auto renderer = std::make_shared<RingRenderer>(session, scene, settings);
    BenchRow row =
        row_of(make_measurement("trace", scene, settings, array_text(settings)), format, renderer, trace_seconds);
    row.work = ring_kernel_work(settings, renderer->render()).front();
    return row;
}

// Prepares a row that measures whole renders by the host's clock, from the packed scene to the image. `variant`: none,
// grid or bvh for the ring machine of `settings` with that --accel; torus for 4 x 4 x 4 nodes without a memory limit.
// Throws UserError for another variant.
BenchRow render_row(Session& session, const Scene& scene, const RingSettings& settings, const NumberFormat& format,
                    const std::string& variant) {
    const bool packets = variant == "packets";
    const TuningKey key = Workload{packets ? "bvh" : variant, format}.key();
    RingSettings s = settings;
    s.format = format;
    if (key.torus) {
        const TorusSettings t = torus_settings_of(s);
        const std::string array = fmt::format("4x4x4 nodes, torus3d, 4x4x4 voxels, {} bounces", t.bounces);
        return row_of(make_measurement("torus", scene, s, array), format,
                      std::make_shared<TorusRenderer>(session, scene, t), render_seconds);
    }
    s.accel = {.kind = static_cast<AccelKind>(key.accel)};
    if (packets) use_packets(s, s.mapping.kind != RAYA_TILES);
    if (packets && !s.packets)
        throw UserError(fmt::format(
            "--variants packets: needs --format fp32 and tiles that divide the image, not {} and {}x{} pixels",
            format_name(format), s.mapping.width, s.mapping.height));
    return row_of(make_measurement("render, " + variant, scene, s, array_text(s)), format,
                  std::make_shared<RingRenderer>(session, scene, s), render_seconds);
}

// Throws DeviceError if rows of the same format differ in image or number of rays, or if rows of the same format and
// kernel differ in event counts.
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

// Takes `samples` time samples of each row. For a sample, the row renders images for at least 20 ms; the sample is the
// mean time of an image. Samples of different rows alternate, so that other programs disturb all rows equally.
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

// Prints the rays per second, times, speed-up and slow-down of each row.
void print_rows(const std::vector<BenchRow>& rows) {
    std::vector<std::vector<std::string>> table = {{"kernel", "format", "lanes", "group", "Mrays/s best", "median",
                                                    "ms best", "median", "speed-up", "slow-down", "build s", "pixels"}};
    for (const BenchRow& row : rows) {
        table.push_back(
            {row.result.kernel, row.result.format, std::to_string(row.result.lanes),
             std::to_string(row.result.group_size), fmt::format("{:.1f}", row.result.best_rate()),
             fmt::format("{:.1f}", row.result.median_rate()), fmt::format("{:.2f}", 1e3 * row.result.best_s),
             fmt::format("{:.2f}", 1e3 * row.result.median_s),
             fmt::format("{:.2f}", first_row_of_format(rows, row).result.median_s / row.result.median_s),
             fmt::format("{:.2f}", row.result.median_s / first_row_of_kernel_and_lanes(rows, row).result.median_s),
             fmt::format("{:.2f}", row.build_s), row.result.hash.substr(0, 8)});
    }
    fmt::print("{}", text_table(table));
    fmt::print(
        "speed-up: median time of the first row with the same format, divided by the row's median time; slow-down: the "
        "row's median time, divided by that of the first row with the same kernel and lanes;\n"
        "pixels: first digits of the image's hash, checked to be equal in all rows of a format\n");
}

// Measures how often per second the device can execute each operation of the number layer, for each format. Prints the
// best of `samples` samples. Throws DeviceError.
void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples) {
    std::vector<std::vector<std::string>> table = {{"Gop/s", "lanes"}};
    table[0].insert(table[0].end(), kOperations.begin(), kOperations.end());
    std::array<double, kOperations.size()> first_rates{};
    for (const NumberFormat& format : formats) {
        OperationRates operations(session, format, lanes);
        std::array<double, kOperations.size()> rates{};
        for (std::size_t kind = 0; kind < rates.size(); ++kind) rates[kind] = operations.measure(kind, samples);
        if (table.size() == 1) first_rates = rates;
        table.push_back({format_name(format), std::to_string(lanes)});
        for (std::size_t i = 0; i < rates.size(); ++i)
            table.back().push_back(
                fmt::format("{:.2f} ({:.1f} x)", rates[i] * 1e-9, rates[i] > 0 ? first_rates[i] / rates[i] : 0));
    }
    fmt::print("\noperations of the number layer, best of {}; in brackets the time relative to {}\n{}",
               counted(static_cast<std::uint64_t>(samples), "sample"), format_name(formats.front()), text_table(table));
}

// Prints the names of the files of tuned values (raya tune) that the rows used.
void print_tuned(const std::vector<BenchRow>& rows) {
    std::set<std::string> files;
    for (const BenchRow& row : rows)
        if (row.tuned != "defaults" && row.tuned != "options") files.insert(row.tuned);
    for (const std::string& file : files) fmt::print("tuned: {}\n", printable(file));
}

// Measures the device's peak for each format and number of lanes, and adds to `report` the roofline of each row that
// measures a single kernel, from its best sample. If a peak cannot be measured, the report contains the reason.
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

// Returns the rows as a report. The report has times only after take_samples().
BenchReport bench_report(const std::vector<BenchRow>& rows, const DeviceInfo& device) {
    BenchReport report{.raya = raya_version(),
                       .device = device.name,
                       .platform = device.platform,
                       .version = device.version,
                       .driver = device.driver,
                       .rows = {}};
    for (const BenchRow& row : rows) report.rows.push_back(row.result);
    return report;
}


std::string seconds_text(double s) { return fmt::format("{:.2f}", s); }


// Renders the scene once for each pair of a format and a variant (none, grid, bvh, packets or torus). Returns the
// build time, the time of the first launch and the binary size of each kernel. A unique build option bypasses the
// driver's cache. If the first variant is a ring machine without dynamic mapping, also renders the scene on this
// machine with each of the two anti-aliasing methods. Throws DeviceError, and UserError for an unknown variant.
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
            for (KernelBuild& build : recorded.all) {
                std::string& options = build.options;
                if (const auto position = options.find(unique_option); position != options.npos)
                    options.erase(position > 0 ? position - 1 : position,
                                  unique_option.size() + (position > 0 ? 1 : 0));
                builds.push_back({.kernel = build.name,
                                  .variant = variant,
                                  .format = format_name(format),
                                  .lanes = lanes,
                                  .build_s = build.build_s,
                                  .launch_s = build.launch_s,
                                  .build_options = options});
            }
            recorded.all.clear();
        }
    }
    session.ignore(recorded);
    return builds;
}

void print_builds(const std::vector<BenchBuild>& builds) {
    std::vector<std::vector<std::string>> table = {
        {"kernel", "variant", "format", "lanes", "build s", "first launch s"}};
    double build_s = 0, launch_s = 0;
    for (const BenchBuild& build : builds) {
        table.push_back({build.kernel, build.variant, build.format, std::to_string(build.lanes),
                         seconds_text(build.build_s), seconds_text(build.launch_s)});
        build_s += build.build_s;
        launch_s += build.launch_s;
    }
    fmt::print("{}first launch: includes the compilation that the driver defers until the first launch\n",
               text_table(table));
    fmt::print("total: {} s of builds, {} s of first launches\n", seconds_text(build_s), seconds_text(launch_s));
}

struct BaselineOptions {
    std::string baseline;  // file of --compare
    double tolerance_percent = 10;
};

Json compared_json(const BaselineOptions& options, const BenchComparison& comparison) {
    Json rows = Json::array();
    for (const ComparedRow& row : comparison.rows) rows.push_back(to_json(row));
    return {{"baseline", options.baseline},
            {"tolerance_percent", options.tolerance_percent},
            {"remarks", comparison.remarks},
            {"compared", comparison.compared},
            {"slower", comparison.slower},
            {"other_images", comparison.other_images},
            {"rows", rows}};
}

// Returns the report of --compare; without --compare, an empty one. Throws UserError if the file or the tolerance is
// not valid. Called before the measurements, so that an error is reported before they take their time.
BenchReport read_baseline(const BaselineOptions& options) {
    if (options.baseline.empty()) return {};
    return read_bench_report(options.baseline);
}

// Throws UserError if the baseline has no row of this run.
void check_comparable(const BaselineOptions& options, const BenchReport& baseline, const BenchReport& measured) {
    if (options.baseline.empty() || rows_in_common(baseline, measured) > 0) return;
    const BenchMeasurement &old_row = baseline.rows.front(), &new_row = measured.rows.front();
    throw UserError(fmt::format(
        "{}: contains no row of this run: its first row is {}, {}, {}, {}, {} lanes, group {}; the first row of this "
        "run is {}, {}, {}, {}, {} lanes, group {}; remedy: use the scene and options of the baseline, or write a new "
        "baseline (raya bench --report)",
        options.baseline, old_row.scene, old_row.size, old_row.array, old_row.format, old_row.lanes, old_row.group_size,
        new_row.scene, new_row.size, new_row.array, new_row.format, new_row.lanes, new_row.group_size));
}

// Compares with the baseline, if there is one. Writes all files, and prints the comparison. Throws CheckFailure if a
// row is slower or has a different image.
void write_and_compare(const BaselineOptions& options, const ReportFiles& files, const BenchReport& baseline,
                       BenchReport measured) {
    if (options.baseline.empty()) return write_report_and_page(files, to_json(measured));
    const BenchComparison comparison = compare_bench(baseline, measured, options.tolerance_percent);
    measured.compared = compared_json(options, comparison);
    write_report_and_page(files, to_json(measured));
    fmt::print("\ncompared with {}, tolerance {} % of its rates:\n{}", printable(options.baseline),
               options.tolerance_percent, comparison.text);
    std::fflush(stdout);
    if (comparison.slower + comparison.other_images > 0)
        throw CheckFailure{fmt::format("{}: {} of {} slower by more than {} %, {} with a different image",
                                       options.baseline, comparison.slower, counted(comparison.compared, "row"),
                                       options.tolerance_percent, comparison.other_images)};
    fmt::print("{} compared, none slower by more than {} %, all images equal\n", counted(comparison.compared, "row"),
               options.tolerance_percent);
}

// Adds --compare, which excludes the option `build`, and --tolerance, which needs --compare.
void add_baseline_options(CLI::App& command, BaselineOptions& options, CLI::Option* build) {
    CLI::Option* compare =
        add_file(command, FileUse::kRead, "--compare", options.baseline, "FILE.json",
                 "Compare the rows with those of an earlier --report: exit code 4 if a row is slower or its image "
                 "differs",
                 "Compare with an earlier report: exit code 4 if slower")
            ->excludes(build);
    in_range(add_value(command, "--tolerance", options.tolerance_percent,
                       "With --compare: tolerance in percent, 0..100; a row is slower if both its best and its median "
                       "rate fall by more than the tolerance"),
             0, 100, "percent")
        ->type_name("PERCENT")
        ->capture_default_str()
        ->needs(compare);
}

struct BenchCommand {
    RenderOptions render;
    std::vector<std::uint32_t> lanes = {1, 4, 8, 16};
    std::vector<std::string> variants;
    std::uint32_t samples = 7;  // number of time samples of each row
    ReportFiles files;          // of --report and --page
    BaselineOptions compare;
    bool build = false;
    std::optional<double> limit_s;  // maximum seconds to compile a kernel
};

void write_and_check_builds(const BenchCommand& command, const BenchReport& report) {
    fmt::print("compiled for {} {} {}\n", report.platform, report.device, report.driver);
    print_builds(report.builds);
    write_report_and_page({command.files.report, ""}, to_json(report));
    for (const BenchBuild& build : report.builds)
        if (command.limit_s && build.build_s + build.launch_s > *command.limit_s)
            throw CheckFailure{fmt::format("{}, {}, {}, {} lanes: {:.1f} s to compile, above --limit {} s",
                                           build.kernel, build.variant, build.format, build.lanes,
                                           build.build_s + build.launch_s, *command.limit_s)};
}

// Prepares the rows of one format. With --variants, a row times whole renders of a variant. Without --variants, a row
// times the trace kernel with a number of lanes.
std::vector<BenchRow> rows_of(const BenchCommand& command, Session& session, const Scene& scene,
                              const RingSettings& settings, const NumberFormat& format) {
    std::vector<BenchRow> rows;
    for (const std::string& variant : command.variants)
        rows.push_back(render_row(session, scene, settings, format, variant));
    if (!command.variants.empty()) return rows;
    for (const std::uint32_t lanes : command.render.lanes ? std::vector{*command.render.lanes} : command.lanes)
        rows.push_back(trace_row(session, scene, settings, format, lanes));
    return rows;
}

std::vector<BenchRow> prepare_rows(const BenchCommand& command, Session& session, const Scene& scene,
                                   const RingSettings& settings, const std::vector<NumberFormat>& formats) {
    std::vector<BenchRow> rows;
    for (const NumberFormat& format : formats)
        std::ranges::move(rows_of(command, session, scene, settings, format), std::back_inserter(rows));
    check_rows(rows);
    return rows;
}

// If the torus is the only variant, refuses the options of ring machines, because they would have no effect.
void refuse_unused_options(const CLI::App& parser, const BenchCommand& command) {
    if (command.variants.empty() || std::ranges::count(command.variants, "torus") < std::ssize(command.variants))
        return;
    for (const char* option : {"--machine", "--pes", "--offset", "--mapping", "--fold", "--pe-memory"})
        if (parser.count(option) > 0)
            throw UserError(
                fmt::format("{} with --variants torus: no effect, because the torus has 4x4x4 nodes without a memory "
                            "limit; leave out {}, or add the variant none",
                            option, option));
}

Scene scene_of(const BenchCommand& command) {
    Scene scene = command.render.scene.empty()
                      ? parse_nff(embedded_files().at("scenes/spheres.nff"), "scenes/spheres.nff")
                      : read_scene(command.render.scene, command.render.strict).scene;
    change_view(command.render.view, scene);
    return scene;
}

// Measures compile times, for --build.
BenchReport time_builds(const BenchCommand& command, Session& session, const Scene& scene, const RingSettings& settings,
                        const std::vector<NumberFormat>& formats) {
    const std::vector<std::string> variants =
        command.variants.empty() ? std::vector<std::string>{"none", "grid", "bvh", "torus"} : command.variants;
    BenchReport report = bench_report({}, session.device());
    report.builds = bench_builds(session, scene, settings, formats, variants);
    return report;
}

void print_tables(const BenchCommand& command, Session& session, const std::vector<BenchRow>& rows,
                  const std::vector<NumberFormat>& formats) {
    print_rows(rows);
    print_tuned(rows);
    if (command.variants.empty())
        print_operations(session, formats, command.render.lanes.value_or(default_lanes(session.device())),
                         command.samples);
}

void bench(const CLI::App& parser, BenchCommand command) {
    Warnings warnings;
    warn_of_build_options(warnings);
    refuse_unused_options(parser, command);
    if (!command.files.page.empty()) check_page_name("--page", command.files.page);
    const BenchReport baseline = read_baseline(command.compare);
    const std::vector<NumberFormat> formats =
        parse_formats(command.render.format.empty() ? "fp32,spa22" : command.render.format);
    command.render.format.clear();
    const Scene scene = scene_of(command);
    const ScopedTunedSource tuned = use_tuned(command.render.no_tuned);
    const RingSettings settings = ring_settings(command.render, scene);
    std::optional<ProgressBar> bar(std::in_place, true, command.build ? "compiling" : "preparing");
    const cl::Device device = choose_device(command.render.device);
    Session session(device);
    if (command.build) {
        const BenchReport report = time_builds(command, session, scene, settings, formats);
        bar.reset();
        return write_and_check_builds(command, report);
    }
    session.announce_compiling();
    std::vector<BenchRow> rows = prepare_rows(command, session, scene, settings, formats);
    check_comparable(command.compare, baseline, bench_report(rows, session.device()));
    bar->stage("taking samples");
    take_samples(rows, command.samples);
    bar.reset();
    fmt::print("{} on {}: {} x {} pixels, {}, {}, {}; {} of 20 ms or more after a warm-up\n", printable(scene.name),
               session.device().name, settings.mapping.width, settings.mapping.height,
               counted(settings.mapping.pes, "PE"), counted(settings.bounces, "bounce"),
               counted(rows.front().result.rays, "ray"), counted(command.samples, "sample"));
    print_tables(command, session, rows, formats);
    BenchReport measured = bench_report(rows, session.device());
    if (!command.files.page.empty()) {
        const ProgressBar measuring(true, "measuring the device's peak");
        add_rooflines(measured, rows, device);
    }
    write_and_compare(command.compare, command.files, baseline, std::move(measured));
}

}  // namespace

void add_bench_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("bench", "Measure rays per second by kernel, lanes and format on this device");
    add_examples(*command, {{"raya bench --size 256 --report today.json",
                             "Measure fp32 and e6m15 with each number of lanes, and write a report for --compare"},
                            {"raya bench scenes/centre.nff --size 128 --samples 3 --variants none,bvh",
                             "Time whole renders of a scene, without accelerator and with a BVH"}});
    const auto options = std::make_shared<BenchCommand>();
    OptionGroup group(*command, "Workload");
    add_file(*command, FileUse::kRead, "SCENE", options->render.scene, "SCENE",
             std::string(kSceneHelp) + "; default: 30 spheres and a plane, 512 x 512");
    add_render_options(*command, options->render, false);
    add_value(
        *command, "--variants", options->variants,
        "Time whole renders instead of the trace kernel, for a comma-separated list of variants; none, grid and bvh "
        "are the ring machine with that --accel; packets is bvh with neighbouring rays together, in fp32 and tiles; "
        "torus is 4x4x4 nodes without a memory limit; raya compares the other variants with the first",
        "Time whole renders instead of the trace kernel")
        ->delimiter(',')
        ->allow_extra_args(false)  // so that the scene may follow
        ->type_name("none,grid,bvh,packets,torus")
        ->excludes(command->get_option("--accel"));
    CLI::Option* build =
        command->add_flag("--build", options->build,
                          "Measure only compilation: compile each kernel of the variants in each format from source, "
                          "and measure the seconds of the build and of the first launch");
    attach_note(build, kBriefNote, "Measure only compilation");
    in_range(add_value(*command, "--limit", options->limit_s,
                       "With --build: maximum seconds to compile a kernel; exit code 4 if a kernel takes longer"),
             0.001, 1e6, "seconds")
        ->type_name("SECONDS")
        ->needs(build);
    in_range(add_value(*command, "--samples", options->samples,
                       "Number of time samples of each row, 1..1000; the best and the median are printed",
                       "Number of time samples of each row, 1..1000"),
             1, 1000)
        ->type_name("N")
        ->capture_default_str();
    group.next("Report and comparison");
    add_file(*command, FileUse::kWritten, "--report", options->files.report, "FILE.json",
             "Write the rows as JSON, for a later --compare; -: stdout; the tables then go to stderr",
             "Write the rows as JSON; -: stdout");
    add_file(
        *command, FileUse::kWritten, "--page", options->files.page, "FILE.html",
        "Write rates, comparison and roofline as an HTML page; raya page makes the same page from a report. Measures "
        "the device's peak for each pair of a format and a number of lanes; each pair takes some seconds",
        "Write rates, comparison and roofline as an HTML page")
        ->excludes(build);
    add_baseline_options(*command, options->compare, build);
    command->get_option("--format")
        ->description("Formats to compare, comma-separated: fp32, spa22 (e6m15), eXmY[t]; default: fp32,spa22");
    command->callback([command, options] { bench(*command, *options); });
}

}  // namespace raya
