// Histories of renders agree with the renders' counts: cycles of each node, words and messages on each link.
#include <algorithm>
#include <catch2/catch.hpp>
#include <stdexcept>

#include "host/torus/async_machine.hpp"
#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

struct RenderHistory {
    raya_torus torus{};
    TorusResult result;
    History history;
};

RenderHistory render_with_history(const Scene& scene, const TorusCase& c) {
    TorusSettings settings = settings_of(c);
    settings.history = true;
    Session session(choose_device(""));
    TorusRenderer renderer(session, scene, settings);
    HistoryRecorder recorder(settings.torus, settings.packets);
    RenderHistory r;
    r.torus = settings.torus;
    r.result = renderer.render({}, {.work = [&](const NodeWork& work) { recorder.add(work); }});
    r.history = recorder.finish();
    return r;
}

std::vector<std::uint64_t> cycles_of_tasks(const RenderHistory& r) {
    std::vector<std::uint64_t> cycles(raya_nodes(r.torus));
    for (const HistoryTask& task : r.history.tasks) cycles[task.node] += task.cycles;
    return cycles;
}

void check_against_counts(const RenderHistory& r) {
    CHECK(cycles_of_tasks(r) == r.result.load.per_pe);
    const auto is_return = [](const HistoryMessage& m) { return m.kind == RAYA_KIND_RETURN; };
    CHECK(static_cast<std::uint64_t>(std::ranges::count_if(r.history.messages, is_return)) == r.result.returns);
    const AsyncResult async = simulate(r.torus, r.history);
    CHECK(async.delivered == r.history.messages.size());
    for (std::size_t link = 0; link < async.links.size(); ++link) {
        REQUIRE(async.links[link].words == r.result.link_words[link]);
        REQUIRE(async.links[link].messages == r.result.link_packets[link]);
    }
    const TorusTime time = torus_time(r.torus, r.result);
    CHECK(async.finish_ms >= time.overlapped_ms * (1 - 1e-9));
    CHECK(async.finish_ms <= time.stepwise_ms);
}

TEST_CASE("cycles, words and messages of a history equal the render's counts, on every kind of machine", "[torus]") {
    for (const TorusCase& c :
         quick(2, {TorusCase{.nodes = {2, 2, 2}, .voxels = {3, 3, 3}},
                   TorusCase{
                       .nodes = {4, 4, 4}, .links = Links::kTorus2d, .inject = Injection::kRoot, .packets = {22, true}},
                   TorusCase{.nodes = {2, 3, 2}, .voxels = {5, 3, 4}, .inject = Injection::kRoot, .queue = 120},
                   TorusCase{.nodes = {1, 1, 1}, .voxels = {3, 2, 2}}, TorusCase{.nodes = {2, 2, 1}, .group = 4}})) {
        CAPTURE(case_text(c));
        check_against_counts(render_with_history(random_view_scene(kSceneSeeds[0]), c));
    }
    check_against_counts(  // wide rays
        render_with_history(far_mirror_scene(1, "fp32"), {.nodes = {2, 2, 1}, .voxels = {3, 2, 2}}));
}

TEST_CASE("the cost of discarded rays is added to the cost of the rays that the node keeps", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    HistoryRecorder recorder(torus);
    const auto primary = [](std::uint32_t pixel) { return raya_processed{pixel, RAYA_KIND_PRIMARY, 0, 100}; };
    const std::vector<raya_processed> two_rays = {primary(4), primary(5)};
    recorder.add({.node = 0, .injection_cycles = 70});
    recorder.add({.node = 1, .injection_cycles = 20});
    recorder.add({.node = 0, .injection_cycles = 31, .processed = two_rays, .queue = std::vector<raya_packet>(2)});
    recorder.add({.node = 0, .injection_cycles = 5});
    const History h = recorder.finish();
    std::vector<std::uint64_t> cycles;
    for (const HistoryTask& task : h.tasks) cycles.push_back(task.cycles);
    CHECK(cycles == std::vector<std::uint64_t>{50, 51, 100, 100, 5, 20});
    CHECK(h.tasks[5].node == 1);

    HistoryRecorder recorder_without_cause(torus);
    const std::vector<raya_processed> shadow = {{4, raya_state(RAYA_KIND_SHADOW, 0, 1), 0, 100}};
    CHECK_THROWS_AS(recorder_without_cause.add({.node = 0, .processed = shadow, .queue = std::vector<raya_packet>(1)}),
                    std::logic_error);
}

TEST_CASE("every injected fault in the cost counters is detected", "[.][faults]") {
    const SourcePatch faults[] = {
        {"torus/trace_voxel.cl", "add_cost(f, event, m, objects);", ""},
        {"torus/packet_batch.clh", "    add_cost(f, event, m, 1);", "    add_cost(f, event, m, 2);"},
        {"torus/trace_voxel.cl", "f->processed.lane[lane] ? f->state.lane[lane] : RAYA_KIND_NONE",
         "f->state.lane[lane]"},
        {"torus/packet_batch.clh", "f->cycles.all = f->processed.all = (index)(0);", "f->processed.all = (index)(0);"}};
    for (const SourcePatch& fault : faults) {
        CAPTURE(fault.find);
        TorusCase c{.nodes = {2, 2, 2}, .voxels = {3, 3, 3}, .queue = 60};
        c.sources.patches = {fault};
        bool detected = false;
        try {
            const RenderHistory r = render_with_history(random_view_scene(kSceneSeeds[0]), c);
            detected = cycles_of_tasks(r) != r.result.load.per_pe;
        } catch (const std::logic_error&) {
            detected = true;
        }
        CHECK(detected);
    }
}

}  // namespace
}  // namespace raya
