// raya bench: rays per second by kernel, lanes and format on this device, each row checked before it is timed.
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/base/progress.hpp"
#include "host/base/say.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cli/bench_build.hpp"
#include "host/cli/bench_rows.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/tuned_option.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/report/bench_compare.hpp"
#include "host/report/render_report.hpp"

namespace raya {
namespace {

struct BenchCommand {
    RenderOptions render;
    std::vector<std::uint32_t> lanes = {1, 4, 8, 16};
    std::vector<std::string> variants;
    std::uint32_t samples = 7;
    std::string report, page, baseline;
    double tolerance = 10;  // percent
    bool denormals = false, build = false;
    std::optional<double> limit;  // seconds
};

// Refuses what could not be compared in the end. Returns the baseline, empty where there is none to be.
BenchReport checked_files(const BenchCommand& command) {
    if (!(command.tolerance >= 0 && command.tolerance <= 100))
        throw UserError(fmt::format("--tolerance {}: must be 0..100 percent", command.tolerance));
    if (!command.page.empty()) check_page_name("--page", command.page);
    if (command.baseline.empty()) return {};
    return read_bench_report(command.baseline);
}

void check_comparable(const BenchCommand& command, const BenchReport& baseline, const BenchReport& now) {
    if (command.baseline.empty() || rows_in_common(baseline, now) > 0) return;
    const BenchMeasurement &was = baseline.rows.front(), &is = now.rows.front();
    throw UserError(fmt::format(
        "{}: no row of this run is in it: it has {}, {}, {}, {}, {} lanes, group {}; this run {}, {}, {}, {}, {} "
        "lanes, group {}; remedy: the same scene and options, or a new baseline by raya bench --report",
        command.baseline, was.scene, was.size, was.array, was.format, was.lanes, was.group_size, is.scene, is.size,
        is.array, is.format, is.lanes, is.group_size));
}

void finish(const BenchCommand& command, const BenchReport& baseline, BenchReport now) {
    BenchComparison result;
    if (!command.baseline.empty()) {
        result = compare_bench(baseline, now, command.tolerance);
        now.compared = {{"baseline", command.baseline}, {"tolerance_percent", command.tolerance},
                        {"remarks", result.remarks},    {"compared", result.compared},
                        {"slower", result.slower},      {"other_images", result.other_images},
                        {"rows", result.rows}};
    }
    write_report_and_page({command.report, command.page}, to_json(now));
    if (command.baseline.empty()) return;
    fmt::print("\nheld against {}, of whose rates a row may lose {} %:\n{}", printable(command.baseline),
               command.tolerance, result.text);
    std::fflush(stdout);
    if (result.failed())
        throw CheckFailure{fmt::format("{}: of {} {} slower by more than {} %, {} with another image", command.baseline,
                                       counted(result.compared, "row"), result.slower, command.tolerance,
                                       result.other_images)};
    fmt::print("{} compared, none slower by more than {} %, the same images\n", counted(result.compared, "row"),
               command.tolerance);
}

// Checked before anything is measured, against what cannot be meant.
void check_build_options(const BenchCommand& command) {
    if (command.limit && !(*command.limit > 0 && *command.limit <= 1e6))
        throw UserError(fmt::format("--limit {}: must be above 0, and 1000000 seconds at most", *command.limit));
}

void finish_builds(const BenchCommand& command, const BenchReport& report) {
    fmt::print("compiled for {} {} {}\n", report.platform, report.device, report.driver);
    print_builds(report.builds);
    write_report_and_page({command.report, ""}, to_json(report));
    for (const BenchBuild& one : report.builds)
        if (command.limit && one.build_s + one.launch_s > *command.limit)
            throw CheckFailure{fmt::format("{}, {}, {}, {} lanes: {:.1f} s to compile, above --limit {} s", one.kernel,
                                           one.variant, one.format, one.lanes, one.build_s + one.launch_s,
                                           *command.limit)};
}

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
    RingSettings flushing = settings;
    flushing.kernels.sources.more_options.emplace_back("-cl-denorms-are-zero");
    std::vector<BenchRow> rows;
    for (const NumberFormat& format : formats) {
        std::ranges::move(rows_of(command, session, scene, settings, format), std::back_inserter(rows));
        if (!command.denormals) continue;
        for (BenchRow& row : rows_of(command, session, scene, flushing, format)) {
            row.flushed = true;
            row.said.kernel += ", flushed";
            rows.push_back(std::move(row));
        }
    }
    check_rows(rows);
    return rows;
}

// What would be passed over without a word.
void refuse_ignored(const CLI::App& parsed, const BenchCommand& command) {
    if (std::ranges::count(command.variants, "torus") < std::max(1L, std::ssize(command.variants))) return;
    for (const char* option : {"--machine", "--pes", "--offset", "--mapping", "--fold", "--pe-memory"})
        if (parsed.count(option) > 0)
            throw UserError(
                fmt::format("{} with --variants torus, which has 4x4x4 nodes without a memory limit: leave "
                            "it out, or add the variant none",
                            option));
}

Scene scene_of(const BenchCommand& command) {
    Scene scene = command.render.scene.empty()
                      ? parse_nff(embedded_files().at("scenes/spheres.nff"), "scenes/spheres.nff")
                      : read_scene(command.render.scene, command.render.strict).scene;
    change_view(command.render.view, scene);
    return scene;
}

void bench(const CLI::App& parsed, BenchCommand command) {
    Warnings warnings;
    warn_of_build_options(warnings);
    refuse_ignored(parsed, command);
    check_build_options(command);
    if (command.samples < 1 || command.samples > 1000)
        throw UserError(fmt::format("--samples {}: must be 1..1000", command.samples));
    const BenchReport baseline = checked_files(command);
    const std::vector<NumberFormat> formats =
        parse_formats(command.render.format.empty() ? "fp32,spa22" : command.render.format);
    command.render.format.clear();
    const Scene scene = scene_of(command);
    const TunedUse tuned = use_tuned(command.render.no_tuned);
    const RingSettings settings = ring_settings(command.render, scene);
    std::optional<ProgressBar> bar(std::in_place, true, command.build ? "compiling" : "preparing");
    const cl::Device device = choose_device(command.render.device);
    Session session(device);
    if (!command.build) session.announce_compiling();
    if (command.build) {
        const std::vector<std::string> variants =
            command.variants.empty() ? std::vector<std::string>{"none", "grid", "bvh", "torus"} : command.variants;
        BenchReport report = bench_report({}, session.device());
        report.builds = bench_builds(session, scene, settings, formats, variants);
        bar.reset();
        return finish_builds(command, report);
    }
    std::vector<BenchRow> rows = prepare_rows(command, session, scene, settings, formats);
    check_comparable(command, baseline, bench_report(rows, session.device()));
    bar->stage("taking samples");
    take_samples(rows, command.samples);
    bar.reset();
    fmt::print("{} on {}: {} x {} pixels, {}, {}, {}; {} of 20 ms or more after a warm-up\n", printable(scene.name),
               session.device().name, settings.mapping.width, settings.mapping.height,
               counted(settings.mapping.pes, "PE"), counted(settings.bounces, "bounce"),
               counted(rows.front().said.rays, "ray"), counted(command.samples, "sample"));
    print_rows(rows);
    print_tuned(rows);
    if (command.denormals) print_denormals(rows);
    if (command.variants.empty())
        print_operations(session, formats, command.render.lanes.value_or(default_lanes(session.device())),
                         command.samples);
    BenchReport now = bench_report(rows, session.device());
    if (!command.page.empty()) {
        const ProgressBar measuring(true, "measuring the device's peak");
        add_rooflines(now, rows, device);
    }
    finish(command, baseline, std::move(now));
}

}  // namespace

void add_bench_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("bench", "Measure rays per second by kernel, lanes and format on this device");
    add_examples(*command, {{"raya bench --size 256 --report today.json",
                             "Rates of fp32 and e6m15 at all widths of lanes, kept for a later comparison"},
                            {"raya bench scenes/centre.nff --size 128 --samples 3 --variants none,bvh",
                             "Whole renders of a scene, every ray against all objects and down a tree of boxes"}});
    const auto options = std::make_shared<BenchCommand>();
    OptionGroup group(*command, "What is measured");
    add_file(*command, FileUse::kRead, "SCENE", options->render.scene, "SCENE.nff",
             "Scene in NFF; -: stdin; default: 30 spheres and a plane, 512 x 512");
    add_render_options(*command, options->render, false);
    add_value(*command, "--variants", options->variants,
              "Time whole renders in place of the trace kernel, in these variants, with commas between them: none, "
              "grid, bvh: the ring machine with that --accel; torus: 4x4x4 nodes without a memory limit; the first "
              "is what the others are held against")
        ->delimiter(',')
        ->allow_extra_args(false)  // what follows is the scene
        ->type_name("none,grid,bvh,torus")
        ->excludes(command->get_option("--accel"));
    CLI::Option* denormals = command->add_flag(
        "--denormals", options->denormals,
        "Time every row once more with denormal numbers taken for 0: where that is faster, lanes compute with them");
    CLI::Option* build =
        command
            ->add_flag("--build", options->build,
                       "List what the driver's compiler takes from source, for each kernel and format of these variants: "
                       "seconds of the build and of the first launch, size of the binary; nothing else is timed")
            ->excludes(denormals);
    add_value(*command, "--limit", options->limit,
              "With --build: seconds that one kernel may take; exit code 4 where one takes longer")
        ->type_name("SECONDS")
        ->needs(build);
    add_value(*command, "--samples", options->samples,
              "Samples of each row, 1..1000; the best and the median are printed")
        ->type_name("N")
        ->capture_default_str();
    group.next("Report and comparison");
    add_file(*command, FileUse::kWritten, "--report", options->report, "FILE.json",
             "Write the rows, for a later --compare; -: stdout, and the tables on stderr");
    add_file(*command, FileUse::kWritten, "--page", options->page, "FILE.html",
             "Write rates, comparison and roofline as a page for a browser; it is what raya page makes of the report. "
             "Measures the device's peak for each format and width of lanes, some seconds each")
        ->excludes(build);
    CLI::Option* compare =
        add_file(*command, FileUse::kRead, "--compare", options->baseline, "FILE.json",
                 "Hold the rows against those of an earlier --report: exit code 4 where a row is slower or its "
                 "image another one")
            ->excludes(build);
    add_value(*command, "--tolerance", options->tolerance,
              "With --compare: percent of its rate, 0..100, that a row may lose; it is slower where its best "
              "and its median have both lost more")
        ->type_name("PERCENT")
        ->capture_default_str()
        ->needs(compare);
    command->get_option("--format")
        ->description(
            "Formats to compare, with commas between them: fp32, spa22 (e6m15), eXmY[t]; default: fp32,spa22");
    command->callback([command, options] { bench(*command, *options); });
}

}  // namespace raya
