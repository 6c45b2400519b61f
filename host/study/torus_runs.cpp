#include "host/study/torus_runs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "host/model/t805.hpp"
#include "host/report/render_report.hpp"
#include "host/scene/generate.hpp"
#include "host/torus/async_machine.hpp"
#include "host/torus/history_recorder.hpp"
#include "host/torus/queue_search.hpp"
#include "host/torus/standstill.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

constexpr std::uint64_t kWordBytes = 4;

TorusSettings settings_of(const TorusPlan& plan, std::uint32_t size) {
    TorusSettings s;
    s.machine = machine_named("torus");
    s.width = s.height = size;
    s.torus = make_torus(plan.nodes, plan.links);
    s.links = plan.links;
    s.voxels = plan.voxels;
    s.inject = plan.inject;
    s.packets = plan.packets;
    s.queue = plan.queue;
    s.pixels = plan.pixels;
    s.bounces = plan.bounces.value_or(s.machine.bounces);
    s.format = s.machine.format;
    s.history = plan.asynchronous;
    return s;
}

// The root's part of torus_time(): what it computes, its end of every message over its links, and those links.
void add_root(TorusRun& run) {
    const TorusResult& r = run.result;
    std::uint64_t cycles = r.load.per_pe[RAYA_ROOT];
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        const std::uint32_t end = raya_link_end(run.torus, RAYA_ROOT, link);
        const std::size_t out = std::size_t{RAYA_ROOT} * RAYA_LINKS + link;
        const std::size_t in = std::size_t{end} * RAYA_LINKS + (link ^ 1u);
        cycles += t805_message_cycles(r.link_packets[out], r.link_words[out]) +
                  t805_message_cycles(r.link_packets[in], r.link_words[in]);
        run.root_link_ms = std::max(run.root_link_ms, t805_link_ms(r.link_words[out], r.link_words[in]));
    }
    run.root_processor_ms = 1e-6 * kT805CycleNs * static_cast<double>(cycles);
}

// Renders with another queue; false where the machine stands still.
bool renders(TorusRenderer& renderer, std::uint32_t queue, const PacketSink& sink, TorusResult& result) {
    renderer.set_queue(queue);
    try {
        result = renderer.render({}, sink);
        return true;
    } catch (const Standstill&) {
        return false;
    }
}

// What follows from the result.
void complete(TorusRun& run) {
    run.result.image = {};
    run.time = torus_time(run.torus, run.result);
    add_root(run);
}

}  // namespace

std::uint64_t TorusRun::rays() const { return ray_count(result.events); }

std::uint64_t TorusRun::tests() const { return test_count(result.events); }

std::uint64_t TorusRun::packets() const {
    return std::accumulate(result.made.begin(), result.made.end(), std::uint64_t{0});
}

double TorusRun::work_ms() const {
    const auto& loads = result.load.per_pe;
    return 1e-6 * kT805CycleNs * static_cast<double>(std::accumulate(loads.begin(), loads.end(), std::uint64_t{0}));
}

double TorusRun::per_ray(std::uint64_t count) const {
    return static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(1, rays()));
}

double TorusRun::hops_per_packet() const {
    return static_cast<double>(result.hops) / static_cast<double>(std::max<std::uint64_t>(1, packets()));
}

std::uint64_t TorusRun::busiest_link_bytes() const {
    return kWordBytes * *std::max_element(result.link_words.begin(), result.link_words.end());
}

double TorusRun::root_ms() const { return std::max(root_processor_ms, root_link_ms); }

std::uint64_t TorusRun::bytes_without_buffers() const {
    return result.node_bytes - node_bytes(0, result.buffers, links_of_node(torus));
}

TorusRun run_on_torus(Session& session, const LabelledScene& scene, std::uint32_t size, const TorusPlan& plan,
                      const PacketSink& sink, History* history) {
    TorusRun run;
    run.plan = plan;
    TorusSettings settings = settings_of(plan, size);
    run.torus = settings.torus;
    const std::uint32_t shortest =
        raya_shortest_queue(static_cast<std::uint32_t>(scene.scene.lights.size()), settings.bounces);
    while (run.plan.queue > 0 && run.plan.queue < shortest) run.plan.queue *= 2;
    settings.queue = run.plan.queue;
    TorusRenderer renderer(session, scene.scene, settings);
    HistoryRecorder recorder(run.torus, plan.packets);
    NodeWorkSink work_sink;
    if (plan.asynchronous) work_sink = [&](const NodeWork& work) { recorder.add(work); };
    try {
        run.result = renderer.render({}, sink, {}, 1, work_sink);
    } catch (const Standstill&) {
        if (plan.queue == 0 || plan.asynchronous) throw;
        QueueTrial trial = renderer.queue_trial();
        trial.most = std::max(default_queue(raya_nodes(run.torus)), shortest);
        trial.ends = [&](const NodeBuffers& buffers) { return renders(renderer, buffers.queue, sink, run.result); };
        const QueueFound found = longer_queue(run.plan.queue, trial);
        if (!found.ends) throw;
        run.plan.queue = found.queue;
    }
    complete(run);
    if (!plan.asynchronous) return run;
    History all = recorder.finish();
    run.time.asynchronous = simulate(run.torus, all).time();
    if (history) *history = std::move(all);
    return run;
}

std::vector<TorusRun> run_groups(Session& session, const LabelledScene& scene, std::uint32_t size, TorusPlan plan,
                                 std::uint32_t groups) {
    const TorusSettings settings = settings_of(plan, size);
    TorusRenderer renderer(session, scene.scene, settings);
    std::vector<TorusRun> runs(groups);
    for (std::uint32_t group = 0; group < groups; ++group) {
        plan.pixels = {groups, group};
        renderer.set_pixels(plan.pixels);
        runs[group].plan = plan;
        runs[group].torus = settings.torus;
        runs[group].result = renderer.render();
        complete(runs[group]);
    }
    return runs;
}

std::array<std::uint32_t, 3> near_cube(std::uint32_t count) {
    if (!std::has_single_bit(count))
        throw std::invalid_argument(fmt::format("near_cube: {} is no power of two", count));
    const auto bits = static_cast<std::uint32_t>(std::countr_zero(count));
    return {1u << (bits + 2) / 3, 1u << (bits + 1) / 3, 1u << bits / 3};
}

LabelledScene even_scene(int count) { return {fmt::format("even-{}", count), generate_uniform(count, {4, 4, 4})}; }

LabelledScene balls_scene(int level) { return {fmt::format("balls-{}", level), generate_balls(level)}; }

}  // namespace raya
