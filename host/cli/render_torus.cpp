// raya render on the torus machine, whose nodes divide the scene among them and exchange rays.
#include <algorithm>
#include <numeric>
#include <optional>

#include "host/base/progress.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/rank_report.hpp"
#include "host/cli/render_command.hpp"
#include "host/torus/async_machine.hpp"
#include "host/torus/buffer_plan.hpp"
#include "host/torus/history.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_trace.hpp"

namespace raya {
namespace {

// The optional outputs of a render, without the image.
struct TorusOutputs {
    TorusOutputs(const RenderCommand& command, const RenderRecorder& recorder, const TorusSettings& settings) {
        if (!command.torus.packets.empty()) packets.emplace();
        keep_packets = command.keep_packets;
        if (recorder.traces()) trace.emplace(settings.torus);
        if (settings.history) history.emplace(settings.torus, settings.packets);
    }

    std::optional<PacketTrace> packets;
    bool keep_packets = false;  // store `records`, `cycles` and `link_words`
    std::vector<PacketRecord> records;
    std::vector<std::uint64_t> cycles, link_words;  // [superstep][node], [superstep][node][RAYA_LINKS]
    std::optional<TorusTrace> trace;
    std::optional<HistoryRecorder> history;
};

TorusResult render_with_progress(TorusRenderer& renderer, RenderProgress& progress, TorusOutputs& outputs,
                                 const Checkpointing* checkpointing) {
    RenderObservers observers;
    if (outputs.trace || outputs.keep_packets)
        observers.supersteps = [&](const SuperstepDetail& step) {
            if (outputs.trace) outputs.trace->add_superstep(step);
            if (!outputs.keep_packets) return;
            outputs.cycles.insert(outputs.cycles.end(), step.cycles.begin(), step.cycles.end());
            outputs.link_words.insert(outputs.link_words.end(), step.link_words.begin(), step.link_words.end());
        };
    if (outputs.packets || outputs.keep_packets || outputs.trace)
        observers.packets = [&](const PacketRecord& record) {
            if (outputs.packets) outputs.packets->add(record);
            if (outputs.keep_packets) outputs.records.push_back(record);
            if (outputs.trace) outputs.trace->add_packet(record);
        };
    if (!outputs.packets && !outputs.keep_packets) observers.packets_every = TorusTrace::kPacketsEvery;
    if (outputs.history) observers.work = [&](const NodeWork& work) { outputs.history->add(work); };
    progress.stage("rendering");
    return renderer.render(progress.callback(), observers, checkpointing);
}

// Renders the image. After a deadlock, searches for a sufficient queue length and throws TorusDeadlock with this
// length.
TorusResult render_or_find_queue(TorusRenderer& renderer, RenderProgress& progress, TorusOutputs& outputs,
                                 const Checkpointing* checkpointing) {
    try {
        return render_with_progress(renderer, progress, outputs, checkpointing);
    } catch (const TorusDeadlock& deadlock) {
        progress.stage("searching for a sufficient queue length");
        const QueueSearchResult search = find_longer_queue(deadlock.figures.queue, renderer.queue_trial());
        throw TorusDeadlock(deadlock.figures, queue_remedy(search));
    }
}

TorusReport torus_report(const TorusSettings& settings, const TorusResult& result) {
    constexpr std::uint64_t kWordBytes = 4;
    const auto& nodes = settings.torus.nodes;
    const auto& words = result.link_words;
    TorusReport t;
    t.nodes = {nodes[0], nodes[1], nodes[2]};
    t.voxels = settings.voxels;
    t.links = links_name(settings.links);
    t.inject = settings.inject == Injection::kRoot ? "root" : "all";
    t.link_exchange = result.links_by_kernel ? "kernel" : "copies";
    t.link_origin = result.links_origin;
    t.packets = settings.packets;
    t.returns = result.returns;
    t.discarded = result.events[RAYA_DISCARDED];
    t.supersteps = result.supersteps.size();
    for (const Superstep& step : result.supersteps) t.live_max = std::max(t.live_max, step.live);
    t.made = result.made;
    t.ended = result.ended;
    t.hops = result.hops;
    t.link.count = std::uint64_t{raya_nodes(settings.torus)} * links_of_node(settings.torus);
    t.link.max_bytes = kWordBytes * *std::max_element(words.begin(), words.end());
    t.link.total_bytes = kWordBytes * std::accumulate(words.begin(), words.end(), std::uint64_t{0});
    t.link.sent.assign(words.size() / RAYA_LINKS, 0);
    for (std::size_t i = 0; i < words.size(); ++i) {
        t.link.by_direction[i % RAYA_LINKS] += kWordBytes * words[i];
        t.link.sent[i / RAYA_LINKS] += kWordBytes * words[i];
    }
    t.queue = result.buffers.queue;
    t.box = result.buffers.box;
    t.queue_max = result.queue_max;
    t.copies = result.copies;
    t.modelled = torus_time(settings.torus, result);
    return t;
}

void write_images(const RenderCommand& command, const TorusResult& result, const RenderReport& report,
                  const Scene& scene, TorusOutputs& outputs, SpanLog& spans) {
    const SpanLog::Span span(&spans, "write images");
    write_main_image(command, result.image, image_attributes(report, scene.name));
    if (outputs.packets) write_whole_file(command.torus.packets, outputs.packets->finish());
}

void refuse_history_with_ranks(const TorusSettings& settings, const Ranks& ranks) {
    if (settings.history && ranks.has_several())
        throw UserError("--async and --replay record every packet in one process; start raya without mpirun");
}

void refuse_checkpoint_with_records(const RenderCommand& command, const RenderRecorder& recorder,
                                    const TorusSettings& settings) {
    if (!command.checkpoint.file.empty() && (!command.torus.packets.empty() || recorder.traces() || settings.history))
        throw UserError(
            "--checkpoint with --machine torus: a checkpoint does not contain what --packets, --trace, --async and "
            "--replay record; leave out one or the other");
}

void write_replay(const ReplayFiles& files, const raya_torus& torus, const History& history) {
    write_whole_file(files.platform, simgrid_platform(torus, {}));
    write_whole_file(files.replay, simgrid_replay(torus, history, {}));
}

void add_asynchronous_time(TorusReport& report, const RenderCommand& command, const TorusSettings& settings,
                           const History& history, SpanLog& spans) {
    report.modelled.asynchronous = spans.during("simulate", [&] { return simulate(settings.torus, history).time(); });
    if (!command.torus.replay.empty()) write_replay(ReplayFiles(command.torus.packets), settings.torus, history);
}

RenderReport make_report(const RenderCommand& command, const SceneInput& input, const TorusSettings& settings,
                         const DeviceInfo& device, const TorusResult& result) {
    RenderReport report = begin_report(command, input, device, result);
    report.machine = {.name = settings.machine.name,
                      .topology = links_name(settings.links),
                      .mapping = "voxels",
                      .fold = {},
                      .format = format_name(settings.format),
                      .pes = raya_nodes(settings.torus),
                      .offset = {},
                      .bounces = settings.bounces,
                      .length_exponent = result.scale.exponent,
                      .pe_memory_bytes = settings.memory_bytes.value_or(0),
                      .pe_memory_used_bytes = result.node_bytes};
    report.events = result.events;
    report.load = result.load;
    report.torus = torus_report(settings, result);
    return report;
}

}  // namespace

std::optional<Render> render_on_torus(const RenderCommand& command, RenderRun& run) {
    Ranks& ranks = run.ranks;
    RenderRecorder& recorder = run.recorder;
    SceneInput& input = run.input;
    const Scene& scene = input.scene;
    TorusSettings settings = torus_settings(run.options, command.torus, scene);
    settings.pixels = command.pixels;
    refuse_history_with_ranks(settings, ranks);
    refuse_checkpoint_with_records(command, recorder, settings);
    Session& session = run.session();
    TorusRenderer renderer(session, scene, settings, ranks, [&] { drop_objects(input.scene); });
    if (ranks.is_first()) warn_of_lost_objects(scene, renderer.scale(), settings.format, input.warnings);
    TorusOutputs outputs(command, recorder, settings);
    const CheckpointFile checkpoint(command.checkpoint);
    TorusResult result = render_or_find_queue(renderer, run.progress, outputs, checkpoint.checkpointing());
    RenderReport report;
    std::optional<History> history;
    if (ranks.is_first()) {
        run.progress.stage("writing");
        report = make_report(command, input, settings, session.device(), result);
        if (outputs.history) {
            run.progress.stage("simulating");
            history = outputs.history->finish();
            add_asynchronous_time(*report.torus, command, settings, *history, recorder.spans());
        }
        write_images(command, result, report, scene, outputs, recorder.spans());
    }
    add_measured(report, command, run,
                 rank_work("nodes", settings.format, result, torus_kernel_work(settings, result)));
    if (!ranks.is_first()) return {};
    run.progress.end();
    report.warnings = input.warnings.texts();
    recorder.spans().during("write report", [&] { write_report(command, report); });
    checkpoint.remove();
    const ProgressBar tracing(recorder.traces(), "writing the trace");
    recorder.write(session, [&](TraceFile& file) { outputs.trace->add_to(file, result, command.trace.pes); });
    return Render{.report = std::move(report),
                  .torus = std::move(result),
                  .packets = std::move(outputs.records),
                  .torus_settings = settings,
                  .lights = static_cast<std::uint32_t>(scene.lights.size()),
                  .history = std::move(history),
                  .cycles = std::move(outputs.cycles),
                  .link_words = std::move(outputs.link_words)};
}

}  // namespace raya
