// raya bench: measures rays per second on a device by kernel, lanes and format. Compares the images of all rows before
// it times the first row.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_options.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/table.hpp"
#include "host/scene/scene.hpp"
#include "host/tune/bench_rows.hpp"

namespace raya {
namespace {

// Prints the rays per second, times, speed-up and slow-down of each row.
void print_rows(const std::vector<BenchRow>& rows) {
    std::vector<std::vector<std::string>> table = {{"kernel", "format", "lanes", "group", "Mrays/s best", "median",
                                                    "ms best", "median", "speed-up", "slow-down", "build s", "pixels"}};
    for (const BenchRow& row : rows) {
        const auto in_first_format = std::ranges::find_if(rows, [&](const BenchRow& r) {
            return r.result.kernel == row.result.kernel && r.result.lanes == row.result.lanes;
        });
        table.push_back({row.result.kernel, row.result.format, std::to_string(row.result.lanes),
                         std::to_string(row.result.group_size), fmt::format("{:.1f}", row.result.best_rate()),
                         fmt::format("{:.1f}", row.result.median_rate()),
                         fmt::format("{:.2f}", 1e3 * row.result.best_s),
                         fmt::format("{:.2f}", 1e3 * row.result.median_s),
                         fmt::format("{:.2f}", first_row_of_format(rows, row).result.median_s / row.result.median_s),
                         fmt::format("{:.2f}", row.result.median_s / in_first_format->result.median_s),
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

void print_builds(const std::vector<BenchBuild>& builds) {
    std::vector<std::vector<std::string>> table = {
        {"kernel", "variant", "format", "lanes", "build s", "first launch s"}};
    double build_s = 0, launch_s = 0;
    for (const BenchBuild& build : builds) {
        table.push_back({build.kernel, build.variant, build.format, std::to_string(build.lanes),
                         fmt::format("{:.2f}", build.build_s), fmt::format("{:.2f}", build.launch_s)});
        build_s += build.build_s;
        launch_s += build.launch_s;
    }
    fmt::print("{}first launch: includes the compilation that the driver defers until the first launch\n",
               text_table(table));
    fmt::print("total: {:.2f} s of builds, {:.2f} s of first launches\n", build_s, launch_s);
}

struct BenchCommand {
    RenderOptions render;
    std::vector<std::uint32_t> lanes = {1, 4, 8, 16};
    std::vector<std::string> variants;
    std::uint32_t samples = 7;  // number of time samples of each row
    ReportFiles files;          // of --report and --page
    std::string list_file;      // of --json-benchmark
    std::string baseline;       // file of --compare
    double tolerance_percent = 10;
    bool build = false;
    std::optional<double> limit_s;  // maximum seconds to compile a kernel
};

// Throws UserError if the baseline has no row of this run.
void check_comparable(const BenchCommand& options, const BenchReport& baseline, const BenchReport& measured) {
    if (options.baseline.empty() || rows_in_common(baseline, measured) > 0) return;
    const auto text_of = [](const BenchMeasurement& row) {
        return fmt::format("{}, {}, {}, {}, {} lanes, group {}", row.scene, row.size, row.array, row.format, row.lanes,
                           row.group_size);
    };
    throw UserError(fmt::format(
        "{}: contains no row of this run: its first row is {}; the first row of this run is {}; remedy: use the scene "
        "and options of the baseline, or write a new baseline (raya bench --report)",
        options.baseline, text_of(baseline.rows.front()), text_of(measured.rows.front())));
}

// Writes all rows as a list of times, in the form of github-action-benchmark's tool customSmallerIsBetter.
void write_list(const std::string& file, const BenchReport& report) {
    if (file.empty()) return;
    Json list = Json::array();
    for (const BenchMeasurement& row : report.rows)
        list.push_back(
            {{"name", fmt::format("{} {}, {} lanes, group {}", row.kernel, row.format, row.lanes, row.group_size)},
             {"unit", "ms"},
             {"value", 1e3 * row.median_s}});
    for (const BenchBuild& build : report.builds)
        list.push_back({{"name", fmt::format("build of {} {}, {}", build.kernel, build.format, build.variant)},
                        {"unit", "s"},
                        {"value", build.build_s}});
    write_whole_file(file, json_dump(list, 2) + "\n");
}

// Compares with the baseline, if there is one. Writes all files, and prints the comparison. Throws CheckFailure if a
// row is slower or has a different image.
void write_and_compare(const BenchCommand& options, const BenchReport& baseline, BenchReport measured) {
    write_list(options.list_file, measured);
    if (options.baseline.empty()) return write_report_and_page(options.files, to_json(measured));
    BenchComparison comparison = compare_bench(baseline, measured, options.tolerance_percent);
    comparison.baseline = options.baseline;
    measured.compared = comparison;
    write_report_and_page(options.files, to_json(measured));
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

void write_and_check_builds(const BenchCommand& command, const BenchReport& report) {
    fmt::print("compiled for {} {} {}\n", report.device.platform, report.device.name, report.device.driver);
    print_builds(report.builds);
    write_list(command.list_file, report);
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

void bench(const CLI::App& parser, BenchCommand command) {
    Warnings warnings;
    warn_of_build_options(warnings);
    const auto& variants = command.variants;
    if (!variants.empty() && std::ranges::count(variants, "torus") == std::ssize(variants))
        refuse_options_of_other_machines(parser, machine_named("torus"));
    if (!command.files.page.empty()) check_page_name("--page", command.files.page);
    const std::string& old_report = command.baseline;  // read first, because the measurements take long
    const BenchReport baseline = old_report.empty() ? BenchReport{} : read_bench_report(old_report);
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
    check_comparable(command, baseline, bench_report(rows, session.device()));
    bar->stage("taking samples");
    take_samples(rows, command.samples);
    bar.reset();
    fmt::print("{} on {}: {} x {} pixels, {}, {}, {}; {} of 20 ms or more after a warm-up\n", printable(scene.name),
               session.device().name, settings.mapping.width, settings.mapping.height,
               counted(settings.mapping.pes, "PE"), counted(settings.bounces, "bounce"),
               counted(rows.front().result.rays, "ray"), counted(command.samples, "sample"));
    print_rows(rows);
    print_tuned(rows);
    if (variants.empty())
        print_operations(session, formats, command.render.lanes.value_or(default_lanes(session.device())),
                         command.samples);
    BenchReport measured = bench_report(rows, session.device());
    if (!command.files.page.empty()) {
        const ProgressBar measuring(true, "measuring the device's peak");
        add_rooflines(measured, rows, device);
    }
    write_and_compare(command, baseline, std::move(measured));
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
    add_file(*command, FileUse::kRead, "SCENE SCENE", options->render.scene,
             std::string(kSceneHelp) + "; default: 30 spheres and a plane, 512 x 512");
    add_render_options(*command, options->render, false);
    add_value(
        *command, "--variants none,grid,bvh,packets,torus", options->variants,
        "Time whole renders instead of the trace kernel, for a comma-separated list of variants; none, grid and bvh "
        "are the ring machine with that --accel; packets is bvh with neighbouring rays together, in fp32 and tiles; "
        "torus is 4x4x4 nodes without a memory limit; raya compares the other variants with the first",
        "Time whole renders instead of the trace kernel")
        ->delimiter(',')
        ->allow_extra_args(false)  // so that the scene may follow
        ->excludes(command->get_option("--accel"));
    CLI::Option* build =
        command->add_flag("--build", options->build,
                          "Measure only compilation: compile each kernel of the variants in each format from source, "
                          "and measure the seconds of the build and of the first launch");
    attach_note(build, kBriefNote, "Measure only compilation");
    in_range(add_value(*command, "--limit SECONDS", options->limit_s,
                       "With --build: maximum seconds to compile a kernel; exit code 4 if a kernel takes longer"),
             0.001, 1e6, "seconds")
        ->needs(build);
    in_range(add_value(*command, "--samples N", options->samples,
                       "Number of time samples of each row, 1..1000; the best and the median are printed",
                       "Number of time samples of each row, 1..1000"),
             1, 1000)
        ->capture_default_str();
    group.next("Report and comparison");
    add_file(*command, FileUse::kWritten, "--report FILE.json", options->files.report,
             "Write the rows as JSON, for a later --compare; -: stdout; the tables then go to stderr",
             "Write the rows as JSON; -: stdout");
    add_file(*command, FileUse::kWritten, "--json-benchmark FILE.json", options->list_file,
             "Write the median times as a JSON list of name, unit and value, for continuous benchmarks "
             "(customSmallerIsBetter)",
             "Write the median times as a JSON list");
    add_file(
        *command, FileUse::kWritten, "--page FILE.html", options->files.page,
        "Write rates, comparison and roofline as an HTML page; raya page makes the same page from a report. Measures "
        "the device's peak for each pair of a format and a number of lanes; each pair takes some seconds",
        "Write rates, comparison and roofline as an HTML page")
        ->excludes(build);
    CLI::Option* compare =
        add_file(*command, FileUse::kRead, "--compare FILE.json", options->baseline,
                 "Compare the rows with those of an earlier --report: exit code 4 if a row is slower or its image "
                 "differs",
                 "Compare with an earlier report: exit code 4 if slower")
            ->excludes(build);
    in_range(add_value(*command, "--tolerance PERCENT", options->tolerance_percent,
                       "With --compare: tolerance in percent, 0..100; a row is slower if both its best and its median "
                       "rate fall by more than the tolerance"),
             0, 100, "percent")
        ->capture_default_str()
        ->needs(compare);
    command->get_option("--format")
        ->description("Formats to compare, comma-separated: fp32, spa22 (e6m15), eXmY[t]; default: fp32,spa22");
    command->callback([command, options] { bench(*command, *options); });
}

}  // namespace raya
