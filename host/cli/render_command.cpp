#include "host/cli/render_command.hpp"

#include <fmt/core.h>

#include <cmath>

#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/error.hpp"
#include "host/image/plain_png.hpp"
#include "host/ranks/launch.hpp"
#include "host/report/scene_report.hpp"
#include "host/report/table.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

void check_exposure(const RenderCommand& command) {
    constexpr double kMaxStops = 64;  // factors of 2^-64 to 2^64
    if (!command.exposure) return;
    if (!stores_8bit_codes(command.image))
        throw UserError(
            fmt::format("--exposure applies to 8-bit images, and {} has linear colours; leave it out, or name a .png, "
                        ".ppm, .tif or .jpg file",
                        command.image));
    if (!(std::abs(*command.exposure) <= kMaxStops))
        throw UserError(fmt::format("--exposure {}: must be -64..64 stops", *command.exposure));
}

void check_packets_name(const std::string& file) {
    if (!file.ends_with(".gz") && !file.starts_with("/dev/") && !is_standard_stream(file))
        throw UserError(
            fmt::format("--packets {}: raya compresses this file with gzip; choose a name that ends in .csv.gz", file));
}

void check_replay(const CLI::App& parser, const TorusOptions& t) {
    if (t.replay != "simgrid") throw UserError(fmt::format("--replay {}: must be simgrid", t.replay));
    if (!t.packets.ends_with(".csv.gz"))
        throw UserError(
            "--replay simgrid writes FILE.xml and FILE.replay next to the packets: add --packets FILE.csv.gz");
    const ReplayFiles files(t.packets);
    check_files(parser, {{"--replay", files.platform}, {"--replay", files.replay}});
}

}  // namespace

void check_output_files(const CLI::App& parser, const RenderCommand& command) {
    const std::string& packets = command.torus.packets;
    if (!find_launch())  // under mpirun, stdout may be a pseudoterminal although the output goes to a file
        for (const std::string& file : {command.image, command.cost, command.mask, packets})
            refuse_bytes_on_terminal(file);
    check_exposure(command);
    if (!packets.empty()) check_packets_name(packets);
    if (!command.torus.replay.empty()) check_replay(parser, command.torus);
    if (!command.page.empty()) check_page_name("--page", command.page);
    if (!command.image.empty()) check_image_name(command.image, kImageExtensions);
    if (!command.cost.empty()) check_image_name(command.cost, kGreyImageExtensions);
    if (!command.mask.empty()) check_image_name(command.mask, kImageExtensions);
    if (!command.mask.empty() && command.render.antialias != AntialiasMethod::kSupersample)
        throw UserError("--mask requires supersampling: add --antialias supersample");
}

SceneInput read_scene_on_rank_0(RenderRecorder& recorder, RenderOptions& options, Ranks& ranks) {
    SceneInput input;
    if (ranks.is_first()) {
        input = recorder.spans().during("read scene", [&] { return read_scene(options.scene, options.strict); });
        change_view(options.view, input.scene);
    }
    if (!ranks.has_several()) return input;
    const bool ring = machine_named(options.machine).kind == MachineKind::kRing;
    if (ranks.is_first() && ring) options.accel = accel_text(ring_settings(options, input.scene).accel);
    ranks.broadcast(input.scene.name);
    ranks.broadcast(input.scene.view.width);
    ranks.broadcast(input.scene.view.height);
    ranks.broadcast(options.accel);
    return input;
}

void add_preview(RenderReport& report, const RenderCommand& command, const Image& image) {
    const double exposure = command.exposure.value_or(0);
    const Image preview = preview_of(exposure == 0 ? image : as_displayed(image, exposure));
    report.image.preview = {preview.width, preview.height, plain_png(preview)};
}

namespace {

// Returns a report with the members that reports of all machines have.
RenderReport common_report(const RenderCommand& command, const SceneInput& input, const DeviceInfo& device,
                           const RenderSettings& settings, const RenderResult& result) {
    RenderReport report;
    report.raya = raya_version();
    report.scene = input_name(command.render.scene);
    report.view = view_json(input.scene);
    report.skipped = input.remarks;
    report.image = {result.image.width, result.image.height, output_name(command.image), pixel_hash(result.image),
                    stores_8bit_codes(command.image) ? std::optional(command.exposure.value_or(0)) : std::nullopt};
    if (command.needs_report()) add_preview(report, command, result.image);
    report.machine.name = settings.machine.name;
    report.machine.format = format_name(settings.format);
    report.machine.bounces = settings.bounces;
    report.machine.length_exponent = result.scale.exponent;
    report.device = {device.name,          device.platform, device.version,    device.driver,
                     result.build_options, result.lanes,    result.group_size, result.tuned};
    report.events = result.events;
    report.load = result.load;
    report.measured = {result.build_s, result.render_s, result.commands, {}, {}};
    return report;
}

void write_main_image(const RenderCommand& command, const Image& image, ImageAttributes attributes) {
    if (command.image.empty()) return;
    const double exposure = command.exposure.value_or(0);
    if (exposure != 0) attributes.emplace_back("exposure", fmt::format("{}", exposure));
    write_image(command.image, image, attributes, exposure);
}

void write_report(const RenderCommand& command, const RenderReport& report) {
    if (command.needs_report()) write_report_and_page({command.report, command.page}, to_json(report));
    if (!is_quiet() && command.prints) fmt::print("{}", printable(summary_text(report)));
    if (!command.profile || !command.prints) return;
    const auto& measured = report.measured;
    fmt::print("\n{}\n", profile_table(measured.build_s, measured.builds, measured.commands));
    if (report.ranks.empty()) fmt::print("{}", roofline_table(*measured.roofline));
    for (const std::string& text : report.rank_rooflines) fmt::print("{}", text);
}

// Measures the peak of this rank's device, and returns the roofline of the rank's kernels.
Roofline measured_roofline(RenderRun& run, const NumberFormat& format, const RenderResult& result,
                           const std::vector<KernelWork>& kernels) {
    Roofline none;
    none.unavailable = "the counts include those of earlier runs, the times do not";
    if (result.earlier_s > 0) return none;
    run.progress.stage("measuring the device's peak");
    try {
        const DevicePeak peak = run.recorder.spans().during(
            "measure peak", [&] { return device_peak(run.device(), format, result.lanes); });
        if (run.ranks.is_first() && peak.scatter > kMaxScatter)
            run.input.warnings.add(
                fmt::format("three measurements of the device's peak differ by {:.0f} %: another program uses the "
                            "device; fractions of the peak are unreliable",
                            100 * peak.scatter));
        Roofline measured = roofline(peak, kernels, result.commands);
        if (const HostCounters* counters = run.recorder.host_counters())
            measured.host_counts_unavailable = counters->unavailable();
        return measured;
    } catch (const DeviceError& error) {  // not rethrown: the render's figures are valid without a roofline
        none.unavailable = error.what();
        return none;
    }
}

Json rank_json(const Ranks& ranks, const Session& session, const std::string& parts, const RenderResult& result) {
    const DeviceInfo& device = session.device();
    return {{"rank", ranks.rank()},
            {"host", ranks.host()},
            {parts, result.parts_of_rank},
            {"device",
             {{"name", device.name},
              {"platform", device.platform},
              {"version", device.version},
              {"compute_units", device.compute_units},
              {"lanes", result.lanes},
              {"group_size", result.group_size},
              {"bytes_taken", session.bytes_taken()}}},
            {"build_s", result.build_s},
            {"render_s", result.render_s},
            {"messages_sent", result.traffic.messages},
            {"bytes_sent", result.traffic.bytes},
            {"waiting_s", result.traffic.waiting_s},
            {"commands", commands_json(result.commands, true)}};
}

void add_measured(RenderReport& report, const RenderCommand& command, RenderRun& run, const NumberFormat& format,
                  const RenderResult& result, const std::vector<KernelWork>& kernels) {
    Ranks& ranks = run.ranks;
    Session& session = run.session();
    std::optional<Roofline>& roofline = report.measured.roofline;
    if (command.needs_roofline()) roofline = measured_roofline(run, format, result, kernels);
    report.measured.builds = run.recorder.builds();
    report.measured.earlier_s = result.earlier_s;
    run.recorder.gather(session, ranks);
    if (!ranks.has_several()) return;
    Json this_rank = rank_json(ranks, session, is_torus(command) ? "nodes" : "pes", result);
    if (roofline) add_to(this_rank, *roofline);
    for (const std::string& text : ranks.gather(json_dump(this_rank)))
        report.ranks.push_back(parse_json(text, {"the report of a rank"}));
    if (roofline)
        report.rank_rooflines =
            ranks.gather(fmt::format("rank {} on {}, {}\n{}", ranks.rank(), ranks.host(), session.device().name,
                                     roofline_table(*roofline, ranks.is_first())));
}

}  // namespace

std::optional<RenderReport> finish_render(const RenderCommand& command, RenderRun& run, const RenderSettings& settings,
                                          const RenderResult& result, const MachineOutputs& outputs) {
    SpanLog& spans = run.recorder.spans();
    RenderReport report;
    if (run.ranks.is_first()) {
        run.progress.stage("writing");
        report = common_report(command, run.input, run.session().device(), settings, result);
        outputs.describe(report);
        ImageAttributes attributes = {{"scene", run.input.scene.name},
                                      {"machine", report.machine.name},
                                      {"mapping", report.machine.mapping},
                                      {"format", report.machine.format},
                                      {"u", fmt::format("{:.6f}", report.load.imbalance)}};
        if (report.machine.offset) attributes.emplace_back("offset", std::to_string(*report.machine.offset));
        const SpanLog::Span span(&spans, "write images");
        write_main_image(command, result.image, attributes);
        outputs.write_files(attributes);
    }
    add_measured(report, command, run, settings.format, result, outputs.work);
    if (!run.ranks.is_first()) return {};
    run.progress.end();
    report.warnings = run.input.warnings.texts();
    spans.during("write report", [&] { write_report(command, report); });
    remove_checkpoint(command.checkpoint);
    const ProgressBar tracing(run.recorder.traces(), "writing the trace");
    run.recorder.write(run.session(), outputs.add_trace);
    return report;
}

}  // namespace raya
