// raya bench: rays per second by kernel, lanes and format on this device, each row checked before it is timed.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <sstream>

#include "cli/commands.hpp"
#include "cli/parse.hpp"
#include "cli/render_options.hpp"
#include "embedded.hpp"
#include "error.hpp"
#include "kernels/kernel_options.hpp"
#include "report/render_report.hpp"
#include "report/table.hpp"
#include "ring/operation_rates.hpp"
#include "scene/nff_reader.hpp"

namespace raya {
namespace {

struct BenchCommand {
    RenderOptions render;
    std::vector<std::uint32_t> lanes = {1, 4, 8, 16};
    int samples = 7;
};

// One row: a renderer that is ready, and what was measured with it.
struct BenchRow {
    NumberFormat format;
    std::unique_ptr<RingRenderer> renderer;
    RingResult warm_up;
    std::string hash;
    std::vector<double> seconds;  // of each sample, one image each; sorted in the end

    double best() const { return seconds.front(); }
    double median() const { return seconds[seconds.size() / 2]; }
};

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

// The rows take turns, so that a disturbance from outside hits all of them alike.
void take_samples(std::vector<BenchRow>& rows, int samples) {
    for (int i = 0; i < samples; ++i)
        for (BenchRow& row : rows) row.seconds.push_back(sample_seconds(*row.renderer));
    for (BenchRow& row : rows) std::sort(row.seconds.begin(), row.seconds.end());
}

// The first row of the same format, the first row of the same lanes: what a row is compared with.
const BenchRow& first_of_format(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) { return r.format == row.format; });
}
const BenchRow& first_of_lanes(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(),
                         [&](const BenchRow& r) { return r.warm_up.lanes == row.warm_up.lanes; });
}

void print_rows(const std::vector<BenchRow>& rows) {
    std::vector<std::vector<std::string>> table = {{"kernel", "format", "lanes", "group", "Mrays/s best", "median",
                                                    "ms best", "median", "speed-up", "slow-down", "build s", "pixels"}};
    for (const BenchRow& row : rows) {
        const auto rays = static_cast<double>(ray_count(row.warm_up.all.events)) * 1e-6;
        table.push_back({"trace", format_name(row.format), std::to_string(row.warm_up.lanes),
                         std::to_string(row.warm_up.group_size), fmt::format("{:.1f}", rays / row.best()),
                         fmt::format("{:.1f}", rays / row.median()), fmt::format("{:.2f}", 1e3 * row.best()),
                         fmt::format("{:.2f}", 1e3 * row.median()),
                         fmt::format("{:.2f}", first_of_format(rows, row).median() / row.median()),
                         fmt::format("{:.2f}", row.median() / first_of_lanes(rows, row).median()),
                         fmt::format("{:.2f}", row.warm_up.build_s), row.hash.substr(0, 8)});
    }
    fmt::print("{}", text_table(table));
    fmt::print(
        "speed-up: over the first row of the same format; slow-down: against the first row of the same lanes "
        "(medians);\n"
        "pixels: hash of the image, checked to be the same in all rows of a format\n");
}

void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples) {
    std::vector<std::vector<std::string>> table = {{"Gop/s", "lanes"}};
    table[0].insert(table[0].end(), kOperations.begin(), kOperations.end());
    std::array<double, kOperations.size()> first{};
    for (const NumberFormat& format : formats) {
        const auto rates = operation_rates(session, format, lanes, samples);
        if (table.size() == 1) first = rates;
        table.push_back({format_name(format), std::to_string(lanes)});
        for (std::size_t i = 0; i < rates.size(); ++i)
            table.back().push_back(
                fmt::format("{:.2f} ({:.1f} x)", rates[i] * 1e-9, rates[i] > 0 ? first[i] / rates[i] : 0));
    }
    fmt::print("\noperations of the number layer, best of {}; in brackets the time against {}\n{}", samples,
               format_name(formats.front()), text_table(table));
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

std::vector<NumberFormat> parse_formats(const std::string& list) {
    std::vector<NumberFormat> formats;
    std::istringstream words(list);
    for (std::string word; std::getline(words, word, ',');) formats.push_back(parse_format(word));
    return formats;
}

void bench(BenchCommand command) {
    if (command.samples < 1 || command.samples > 1000)
        throw UserError(fmt::format("--samples {}: must be 1..1000", command.samples));
    const std::vector<NumberFormat> formats =
        parse_formats(command.render.format.empty() ? "fp32,spa22" : command.render.format);
    command.render.format.clear();
    const Scene scene = command.render.scene.empty()
                            ? parse_nff(embedded_files().at("scenes/spheres.nff"), "scenes/spheres.nff")
                            : read_nff(command.render.scene);
    const RingSettings settings = ring_settings(command.render, scene);
    if (settings.antialias.method != AntialiasMethod::kNone)
        throw UserError("bench times the trace kernel: leave --antialias out; raya render --profile times the rest");
    Session session(choose_device(command.render.device));
    std::vector<BenchRow> rows;
    for (const NumberFormat& format : formats)
        for (const std::uint32_t lanes : command.render.lanes ? std::vector{*command.render.lanes} : command.lanes)
            rows.push_back(prepare_row(session, scene, settings, format, lanes));
    check_rows(rows);
    take_samples(rows, command.samples);
    fmt::print("{} on {}: {} x {} pixels, {} PEs, {} bounces, {} rays; {} samples of 20 ms or more after a warm-up\n",
               scene.name, session.device().name, settings.mapping.width, settings.mapping.height, settings.mapping.pes,
               settings.bounces, ray_count(rows.front().warm_up.all.events), command.samples);
    print_rows(rows);
    print_operations(session, formats, command.render.lanes.value_or(default_lanes(session.device())), command.samples);
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
    command->get_option("--format")
        ->description(
            "Formats to compare, with commas between them: fp32, spa22 (e6m15), eXmY[t]; default: fp32,spa22");
    refuse_odd_values(*command);
    command->callback([options] { bench(*options); });
}

}  // namespace raya
