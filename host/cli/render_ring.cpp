// raya render on a ring machine, whose PEs divide the pixels among them.
#include <optional>

#include "host/base/log.hpp"
#include "host/cli/render_command.hpp"
#include "host/model/budget.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/ring/ring_report.hpp"
#include "host/ring/ring_result.hpp"
#include "host/ring/schedule.hpp"

namespace raya {
namespace {

void describe(RenderReport& report, const RenderCommand& command, const RingSettings& settings,
              const RingResult& result) {
    report.machine.topology = settings.machine.topology;
    report.machine.pes = settings.mapping.pes;
    report.machine.mapping = settings.dynamic ? dynamic_text(*settings.dynamic) : mapping_text(settings.mapping);
    report.machine.pe_memory_bytes = settings.machine.pe_memory_bytes.value_or(0);
    report.machine.pe_memory_used_bytes = result.pe_memory.bytes();
    if (!settings.dynamic && raya_has_slots(settings.mapping)) {
        report.machine.mapping = command.render.mapping == "column" ? "column" : "cyclic";
        report.machine.fold = settings.mapping.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic";
        report.machine.offset = settings.mapping.parameter;
    }
    report.accel_s = result.accel_s;
    report.counted = !settings.packets;
    report.requests = result.requests;
    for (const Phase& phase : result.phases) report.loads.emplace_back(phase.name, phase.load);
    report.of_machine = ring_report(settings, result);
}

// Converts cycle counts to floats. Counts above 2^24 are rounded.
GreyImage grey_image(const CostImage& cost) {
    return {static_cast<int>(cost.width), static_cast<int>(cost.height), {cost.cycles.begin(), cost.cycles.end()}};
}

}  // namespace

RingSettings ring_settings_of(const RenderCommand& command, const RenderOptions& options, const Scene& scene) {
    RingSettings settings = ring_settings(options, scene);
    settings.record_costs = command.record_costs || !command.cost.empty();
    if (!command.needs_counts()) use_packets(settings, options.mapping.empty() && !options.offset && !options.fold);
    return settings;
}

std::optional<Render> render_on_ring(const RenderCommand& command, RenderRun& run) {
    SceneInput& input = run.input;
    const RingSettings settings = ring_settings_of(command, run.options, input.scene);
    warn_of_slow_search(input.scene, settings.accel.kind != AccelKind::kNone, input.warnings);
    RingRenderer renderer(run.session(), input.scene, settings, run.ranks, [&] { drop_objects(input.scene); });
    if (run.ranks.is_first()) warn_of_lost_objects(input.scene, renderer.scale(), settings.format, input.warnings);
    run.progress.stage("rendering");
    const CheckpointFile checkpoint(command.checkpoint);
    RingResult result = renderer.render(run.progress.callback(), checkpoint.checkpointing());
    auto report = finish_render(
        command, run, settings, result,
        {.describe = [&](RenderReport& r) { describe(r, command, settings, result); },
         .write_files =
             [&](const ImageAttributes& attributes) {
                 if (!command.cost.empty()) write_image(command.cost, grey_image(result.cost()), attributes);
                 if (!command.mask.empty()) write_image(command.mask, result.mask, attributes);
             },
         .add_trace = [&](TraceFile& trace) { add_ring_machine(trace, settings, result, command.trace.pes); },
         .work = ring_kernel_work(settings, result)});
    if (!report) return {};
    return Render{std::move(*report), std::move(result)};
}

}  // namespace raya
