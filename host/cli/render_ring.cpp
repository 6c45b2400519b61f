// raya render on a ring machine, whose PEs divide the pixels among them.
#include <optional>

#include "host/base/progress.hpp"
#include "host/cli/rank_report.hpp"
#include "host/cli/render_command.hpp"
#include "host/model/budget.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/ring/ring_result.hpp"
#include "host/ring/schedule.hpp"

namespace raya {
namespace {

std::optional<Antialiasing> antialiasing(const RingSettings& settings, const RingResult& result) {
    const Antialias& a = settings.antialias;
    if (a.method == AntialiasMethod::kNone) return {};
    Antialiasing report;
    report.method = antialias_name(a.method);
    report.exchange = exchange_name(a.exchange);
    report.band_pixels = result.pe_memory.band_pixels;
    if (a.method == AntialiasMethod::kFilter) return report;
    report.points = points_name(a.points);
    report.threshold = a.threshold;
    report.recomputed = result.recomputed;
    report.recomputed_share = static_cast<double>(result.recomputed) / (1.0 * result.image.width * result.image.height);
    return report;
}

ModelledTime ring_time(const RingSettings& settings, const RingResult& result) {
    std::vector<Load> loads;
    for (const Phase& phase : result.phases) loads.push_back(phase.load);
    return modelled_time(settings.machine.clock, loads, result.communication,
                         smoothing_cycles(settings.antialias.method, largest_share(settings.mapping)));
}

RenderReport make_report(const RenderCommand& command, const SceneInput& input, const RingSettings& settings,
                         const DeviceInfo& device, const RingResult& result) {
    RenderReport report = begin_report(command, input, device, result);
    report.machine = {.name = settings.machine.name,
                      .topology = settings.machine.topology,
                      .mapping = mapping_text(settings.mapping),
                      .fold = {},
                      .format = format_name(settings.format),
                      .pes = settings.mapping.pes,
                      .offset = {},
                      .bounces = settings.bounces,
                      .length_exponent = result.scale.exponent,
                      .pe_memory_bytes = settings.machine.pe_memory_bytes.value_or(0),
                      .pe_memory_used_bytes = result.pe_memory.bytes()};
    if (settings.dynamic) {
        report.machine.mapping = dynamic_text(*settings.dynamic);
    } else if (raya_has_slots(settings.mapping)) {
        const bool is_column = command.render.mapping == "column";
        report.machine.mapping = is_column ? "column" : "cyclic";
        report.machine.fold = settings.mapping.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic";
        report.machine.offset = settings.mapping.parameter;
    }
    report.accel_s = result.accel_s;
    report.counted = !settings.packets;
    report.events = result.all.events;
    report.load = result.all.load;
    report.requests = result.requests;
    for (const Phase& phase : result.phases) report.loads.emplace_back(phase.name, phase.load);
    report.antialias = antialiasing(settings, result);
    report.accel = result.accel;
    report.communication = result.communication;
    report.modelled = ring_time(settings, result);
    return report;
}

// Converts cycle counts to floats. Counts above 2^24 are rounded.
GreyImage grey_image(const CostImage& cost) {
    return {static_cast<int>(cost.width), static_cast<int>(cost.height), {cost.cycles.begin(), cost.cycles.end()}};
}

void write_images(const RenderCommand& command, const RingResult& result, const ImageAttributes& attributes) {
    write_main_image(command, result.image, attributes);
    if (!command.cost.empty()) write_image(command.cost, grey_image(result.cost()), attributes);
    if (!command.mask.empty()) write_image(command.mask, result.mask, attributes);
}

}  // namespace

RingSettings ring_settings_of(const RenderCommand& command, const RenderOptions& options, const Scene& scene) {
    RingSettings settings = ring_settings(options, scene);
    settings.record_costs = command.record_costs || !command.cost.empty();
    if (!command.needs_counts())
        use_packets(settings, options.mapping.empty() && !options.offset && options.fold.empty());
    return settings;
}

std::optional<Render> render_on_ring(const RenderCommand& command, RenderRun& run) {
    Ranks& ranks = run.ranks;
    RenderRecorder& recorder = run.recorder;
    SceneInput& input = run.input;
    const Scene& scene = input.scene;
    const RingSettings settings = ring_settings_of(command, run.options, scene);
    warn_of_slow_search(scene, settings.accel.kind != AccelKind::kNone, input.warnings);
    Session& session = run.session();
    RingRenderer renderer(session, scene, settings, ranks, [&] { drop_objects(input.scene); });
    if (ranks.is_first()) warn_of_lost_objects(scene, renderer.scale(), settings.format, input.warnings);
    run.progress.stage("rendering");
    const CheckpointFile checkpoint(command.checkpoint);
    RingResult result = renderer.render(run.progress.callback(), checkpoint.checkpointing());
    RenderReport report;
    if (ranks.is_first()) {
        run.progress.stage("writing");
        report = make_report(command, input, settings, session.device(), result);
        recorder.spans().during("write images",
                                [&] { write_images(command, result, image_attributes(report, scene.name)); });
    }
    add_measured(report, command, run, rank_work("pes", settings.format, result, ring_kernel_work(settings, result)));
    if (!ranks.is_first()) return {};
    run.progress.end();
    report.warnings = input.warnings.texts();
    recorder.spans().during("write report", [&] { write_report(command, report); });
    checkpoint.remove();
    const ProgressBar tracing(recorder.traces(), "writing the trace");
    recorder.write(session, [&](TraceFile& trace) { add_ring_machine(trace, settings, result, command.trace.pes); });
    return Render{std::move(report), std::move(result)};
}

}  // namespace raya
