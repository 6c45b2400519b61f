// raya bench: rays per second by kernel, lanes and format on this device, each row checked before it is timed.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "cli/commands.hpp"
#include "cli/parse.hpp"
#include "cli/render_options.hpp"
#include "embedded.hpp"
#include "error.hpp"
#include "report/render_report.hpp"
#include "report/table.hpp"
#include "scene/nff_reader.hpp"

namespace raya {
namespace {

struct BenchCommand {
    RenderOptions render;
    std::vector<std::uint32_t> lanes = {1, 4, 8, 16};
    int samples = 7;
};

struct BenchRow {
    std::uint32_t lanes = 0, group = 0;
    std::string hash;
    double build_s = 0;
    std::uint64_t rays = 0;
    std::vector<double> seconds;  // of each sample, one image each
};

double trace_seconds(const RingResult& result) {
    double ns = 0;
    for (const LabelSummary& c : result.commands)
        if (c.label == "trace") ns += static_cast<double>(c.total_ns);
    return ns * 1e-9;
}

// One sample is at least 20 ms of kernel time, so that the clock and the launch do not count.
double sample_seconds(RingRenderer& renderer) {
    constexpr double kLeastSeconds = 0.02;
    double seconds = 0;
    int images = 0;
    while (seconds < kLeastSeconds) {
        const RingResult result = renderer.render();
        const double once = trace_seconds(result);
        seconds += once > 0 ? once : result.render_s;  // a device that does not time its commands: the host's clock
        ++images;
    }
    return seconds / images;
}

BenchRow measure(Session& session, const Scene& scene, RingSettings settings, std::uint32_t lanes, int samples) {
    settings.kernels.lanes = lanes;
    RingRenderer renderer(session, scene, settings);
    const RingResult warm_up = renderer.render();
    BenchRow row{lanes, warm_up.group_size, pixel_hash(warm_up.image), warm_up.build_s, ray_count(warm_up.events), {}};
    for (int i = 0; i < samples; ++i) row.seconds.push_back(sample_seconds(renderer));
    std::sort(row.seconds.begin(), row.seconds.end());
    return row;
}

void print_rows(const std::vector<BenchRow>& rows, const std::string& format) {
    const auto rate = [](const BenchRow& row, double seconds) {
        return static_cast<double>(row.rays) / seconds * 1e-6;
    };
    std::vector<std::vector<std::string>> table = {{"kernel", "lanes", "group", "format", "Mrays/s best", "median",
                                                    "ms best", "median", "ratio", "build s", "pixels"}};
    for (const BenchRow& row : rows) {
        const double best = row.seconds.front(), median = row.seconds[row.seconds.size() / 2];
        table.push_back({"trace", std::to_string(row.lanes), std::to_string(row.group), format,
                         fmt::format("{:.1f}", rate(row, best)), fmt::format("{:.1f}", rate(row, median)),
                         fmt::format("{:.2f}", 1e3 * best), fmt::format("{:.2f}", 1e3 * median),
                         fmt::format("{:.2f}", rows.front().seconds[rows.front().seconds.size() / 2] / median),
                         fmt::format("{:.2f}", row.build_s), row.hash.substr(0, 8)});
    }
    fmt::print("{}", text_table(table));
}

void bench(const BenchCommand& command) {
    if (command.samples < 1 || command.samples > 1000)
        throw UserError(fmt::format("--samples {}: must be 1..1000", command.samples));
    const Scene scene = command.render.scene.empty()
                            ? parse_nff(embedded_files().at("scenes/spheres.nff"), "scenes/spheres.nff")
                            : read_nff(command.render.scene);
    const RingSettings settings = ring_settings(command.render, scene);
    Session session(choose_device(command.render.device));
    std::vector<BenchRow> rows;
    for (const std::uint32_t lanes : command.render.lanes ? std::vector{*command.render.lanes} : command.lanes)
        rows.push_back(measure(session, scene, settings, lanes, command.samples));
    fmt::print("{} on {}: {} x {} pixels, {} PEs, {} bounces, {} rays; {} samples of 20 ms or more after a warm-up\n",
               scene.name, session.device().name, settings.mapping.width, settings.mapping.height, settings.mapping.pes,
               settings.bounces, rows.front().rays, command.samples);
    print_rows(rows, format_name(settings.format));
    fmt::print(
        "ratio: median time of the first row over that of the row; pixels: hash of the image, checked to be the same "
        "in all rows\n");
    for (const BenchRow& row : rows)
        if (row.hash != rows.front().hash || row.rays != rows.front().rays)
            throw DeviceError(
                fmt::format("{} lanes give another image than {} lanes: {} and {}; the device or its compiler is wrong",
                            row.lanes, rows.front().lanes, row.hash, rows.front().hash));
}

}  // namespace

void add_bench_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("bench", "Measure rays per second by kernel, lanes and format on this device");
    const auto options = std::make_shared<BenchCommand>();
    command->add_option("SCENE", options->render.scene, "Scene in NFF; default: 30 spheres and a plane, 512 x 512")
        ->type_name("SCENE.nff");
    add_render_options(*command, options->render);
    command
        ->add_option("--samples", options->samples, "Samples of each row, 1..1000; the best and the median are printed")
        ->type_name("N")
        ->capture_default_str();
    refuse_odd_values(*command);
    command->callback([options] { bench(*options); });
}

}  // namespace raya
