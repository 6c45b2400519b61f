// raya bench: measures rays per second on a device by kernel, lanes and format. Compares the images of all rows before
// it times the first row.
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/base/log.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cli/bench_baseline.hpp"
#include "host/cli/bench_build.hpp"
#include "host/cli/bench_rows.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/scene_input.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/report/render_report.hpp"

namespace raya {
namespace {

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

void check_build_options(const BenchCommand& command) {
    if (command.limit_s && !(*command.limit_s > 0 && *command.limit_s <= 1e6))
        throw UserError(fmt::format("--limit {}: must be above 0 and at most 1000000 seconds", *command.limit_s));
}

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
    check_build_options(command);
    if (command.samples < 1 || command.samples > 1000)
        throw UserError(fmt::format("--samples {}: must be 1..1000", command.samples));
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
    add_value(*command, "--limit", options->limit_s,
              "With --build: maximum seconds to compile a kernel; exit code 4 if a kernel takes longer")
        ->type_name("SECONDS")
        ->needs(build);
    add_value(*command, "--samples", options->samples,
              "Number of time samples of each row, 1..1000; the best and the median are printed",
              "Number of time samples of each row, 1..1000")
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
