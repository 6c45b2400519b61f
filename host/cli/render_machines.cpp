// raya render on a ring machine, whose PEs divide the pixels among them.
#include <fmt/core.h>

#include <optional>

#include "host/cli/render_command.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/ring/ring_result.hpp"
#include "host/torus/async_machine.hpp"
#include "host/torus/history.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/torus/torus_result.hpp"

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
    const auto checkpointing = checkpointing_of(command.checkpoint);
    RingResult result = renderer.render(run.progress.callback(), checkpointing.get());
    auto report = finish_render(
        command, run, settings, result,
        {.describe = [&](RenderReport& r) { describe(r, command, settings, result); },
         .write_files =
             [&] {
                 if (!command.cost.empty()) write_image(command.cost, grey_image(result.cost()));
                 if (!command.mask.empty()) write_image(command.mask, result.mask);
             },
         .add_trace = [&](TraceFile& trace) { add_ring_machine(trace, settings, result, command.trace.pes); },
         .work = ring_kernel_work(settings, result)});
    if (!report) return {};
    return Render{std::move(*report), std::move(result)};
}

namespace {

// The result of a render, and what its observers have recorded.
struct TorusRecords {
    TorusResult result;
    std::vector<PacketRecord> packets;
    std::vector<std::uint64_t> cycles, link_words;  // [superstep][node], [superstep][node][RAYA_LINKS]
    std::optional<HistoryRecorder> history;
};

TorusRecords render_recorded(const RenderCommand& command, const TorusSettings& settings, RenderRun& run,
                             TorusRenderer& renderer, const Checkpointing* checkpointing) {
    TorusRecords records;
    RenderObservers observers;
    if (command.keep_packets || run.recorder.traces())
        observers.supersteps = [&](const SuperstepDetail& step) {
            records.cycles.insert(records.cycles.end(), step.cycles.begin(), step.cycles.end());
            records.link_words.insert(records.link_words.end(), step.link_words.begin(), step.link_words.end());
        };
    if (command.keep_packets) observers.packets = [&](const PacketRecord& p) { records.packets.push_back(p); };
    if (settings.history) {
        records.history.emplace(settings.torus, settings.packets);
        observers.work = [&](const NodeWork& work) { records.history->add(work); };
    }
    run.progress.stage("rendering");
    records.result = renderer.render(run.progress.callback(), observers, checkpointing);
    return records;
}

// Renders the image. After a deadlock, repeats the render with queues of twice the length.
TorusRecords render_without_deadlock(const RenderCommand& command, const TorusSettings& settings, RenderRun& run,
                                     TorusRenderer& renderer, const Checkpointing* checkpointing) {
    for (;;) try {
            return render_recorded(command, settings, run, renderer, checkpointing);
        } catch (const TorusDeadlock& deadlock) {
            if (checkpointing != nullptr) throw;  // a checkpoint belongs to one length
            const std::uint32_t queue = 2 * deadlock.queue;
            renderer.set_queue(queue);
            if (run.ranks.is_first())
                run.input.warnings.add(fmt::format("{}; repeated with queues of {} packets", deadlock.what(), queue));
        }
}

void check_records(const RenderCommand& command, const RenderRun& run, const TorusSettings& settings) {
    if (settings.history && run.ranks.has_several())
        throw UserError("--async records every packet in one process; start raya without mpirun");
    if (!command.checkpoint.file.empty() && (run.recorder.traces() || settings.history))
        throw UserError(
            "--checkpoint with --machine torus: a checkpoint does not contain what --trace and --async record; leave "
            "out one or the other");
}

void describe(RenderReport& report, const TorusSettings& settings, const TorusResult& result) {
    report.machine.topology = links_name(settings.links);
    report.machine.pes = raya_nodes(settings.torus);
    report.machine.mapping = "voxels";
    report.machine.pe_memory_bytes = settings.memory_bytes.value_or(0);
    report.machine.pe_memory_used_bytes = result.node_bytes;
}

}  // namespace

std::optional<Render> render_on_torus(const RenderCommand& command, RenderRun& run) {
    RenderRecorder& recorder = run.recorder;
    SceneInput& input = run.input;
    TorusSettings settings = torus_settings(run.options, command.torus, input.scene);
    settings.pixels = command.pixels;
    check_records(command, run, settings);
    TorusRenderer renderer(run.session(), input.scene, settings, run.ranks, [&] { drop_objects(input.scene); });
    if (run.ranks.is_first()) warn_of_lost_objects(input.scene, renderer.scale(), settings.format, input.warnings);
    const auto checkpointing = checkpointing_of(command.checkpoint);
    TorusRecords records = render_without_deadlock(command, settings, run, renderer, checkpointing.get());
    TorusResult& result = records.result;
    std::optional<History> history;
    std::optional<AsynchronousTime> asynchronous;
    if (records.history && run.ranks.is_first()) {
        run.progress.stage("simulating");
        history = records.history->finish();
        asynchronous = recorder.spans().during("simulate", [&] { return simulate(settings.torus, *history).time(); });
    }
    auto report = finish_render(command, run, settings, result,
                                {.describe =
                                     [&](RenderReport& r) {
                                         describe(r, settings, result);
                                         r.of_machine = torus_report(settings, result, asynchronous);
                                     },
                                 .write_files = {},
                                 .add_trace =
                                     [&](TraceFile& file) {
                                         add_torus_machine(file, settings.torus, result, records.cycles,
                                                           records.link_words, command.trace.pes);
                                     },
                                 .work = torus_kernel_work(settings, result)});
    if (!report) return {};
    if (!command.keep_packets) records.cycles = records.link_words = {};  // of the trace
    return Render{.report = std::move(*report),
                  .torus = std::move(result),
                  .packets = std::move(records.packets),
                  .torus_settings = settings,
                  .lights = static_cast<std::uint32_t>(input.scene.lights.size()),
                  .history = std::move(history),
                  .cycles = std::move(records.cycles),
                  .link_words = std::move(records.link_words)};
}

}  // namespace raya
