// raya render on the torus machine: the scene is divided among the nodes, rays travel between them.
#include <algorithm>
#include <numeric>
#include <optional>

#include "cli/render_command.hpp"
#include "report/progress.hpp"
#include "report/whole_file.hpp"
#include "scene/nff_reader.hpp"
#include "torus/packet_trace.hpp"
#include "torus/torus_time.hpp"

namespace raya {
namespace {

TorusResult render_with_progress(TorusRenderer& renderer, bool wanted, PacketTrace* trace) {
    ProgressBar bar(wanted);
    return renderer.render(bar.active() ? [&](double done) { bar.update(done); } : ProgressCallback{},
                           trace ? [trace](const PacketRecord& record) { trace->add(record); } : PacketSink{});
}

TorusReport torus_report(const TorusSettings& settings, const TorusResult& result) {
    constexpr std::uint64_t kWordBytes = 4;
    const auto& nodes = settings.torus.nodes;
    const auto& words = result.link_words;
    TorusReport t;
    t.nodes = {nodes[0], nodes[1], nodes[2]};
    t.voxels = settings.voxels;
    t.links = settings.machine.topology;
    t.inject = settings.inject == Injection::kRoot ? "root" : "all";
    t.supersteps = result.supersteps.size();
    for (const Superstep& step : result.supersteps) t.live_max = std::max(t.live_max, step.live);
    t.made = result.made;
    t.ended = result.ended;
    t.hops = result.hops;
    t.link.count = std::uint64_t{raya_nodes(settings.torus)} * links_of_node(settings.torus);
    t.link.max_bytes = kWordBytes * *std::max_element(words.begin(), words.end());
    t.link.total_bytes = kWordBytes * std::accumulate(words.begin(), words.end(), std::uint64_t{0});
    t.queue = result.buffers.queue;
    t.box = result.buffers.box;
    t.queue_max = result.queue_max;
    t.copies = result.copies;
    t.modelled = torus_time(settings.torus, result);
    return t;
}

RenderReport make_report(const RenderCommand& command, const TorusSettings& settings, const DeviceInfo& device,
                         const TorusResult& result) {
    RenderReport report = begin_report(command, device, result);
    report.machine = {.name = settings.machine.name,
                      .topology = settings.machine.topology,
                      .mapping = settings.machine.mapping,
                      .fold = {},
                      .format = format_name(settings.format),
                      .pes = raya_nodes(settings.torus),
                      .offset = {},
                      .bounces = settings.bounces,
                      .pe_memory_bytes = settings.memory_bytes.value_or(0),
                      .pe_memory_used_bytes = result.node_bytes};
    report.events = result.events;
    report.load = result.load;
    report.torus = torus_report(settings, result);
    return report;
}

}  // namespace

void render_on_torus(const RenderCommand& command) {
    const Scene scene = read_nff(command.render.scene);
    const TorusSettings settings = torus_settings(command.render, command.torus, scene);
    Session session(choose_device(command.render.device));
    TorusRenderer renderer(session, scene, settings);
    std::optional<PacketTrace> trace;
    if (!command.torus.packets.empty()) trace.emplace();
    const TorusResult result = render_with_progress(renderer, !command.quiet, trace ? &*trace : nullptr);

    const RenderReport report = make_report(command, settings, session.device(), result);
    write_image(command.image, result.image, image_attributes(report, scene.name));
    if (trace) write_whole_file(command.torus.packets, trace->finish());
    write_report(command, report);
}

}  // namespace raya
