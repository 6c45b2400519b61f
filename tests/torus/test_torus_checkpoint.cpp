// Checkpoints of torus renders that must be refused: those of other renders, and damaged ones. Resumed renders:
// tests/ranks/test_renders_on_ranks.cpp.
#include <catch2/catch.hpp>
#include <functional>

#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/base/test_checkpointing.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

/// Renders until the fourth checkpoint, from which the torus can be resumed.
std::string stopped_render(Session& session, const Scene& scene, const TorusSettings& settings) {
    TestCheckpointing checkpointing(4);
    TorusRenderer renderer(session, scene, settings);
    CHECK_THROWS_AS(renderer.render({}, {}, checkpointing.checkpointing()), Stopped);
    return checkpointing.saved();
}

TorusSettings small_torus() { return settings_of({.packets = {20, true}, .queue = 300, .group = 1}); }

}  // namespace

TEST_CASE("torus: a checkpoint of another render is refused with a message that names the difference",
          "[torus][checkpoint]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    const std::string state = stopped_render(session, scene, small_torus());
    const auto check_refused = [&](const Scene& other_scene, const TorusSettings& changed, const char* reason) {
        CAPTURE(reason);
        TestCheckpointing resumed(1 << 30, state);
        TorusRenderer renderer(session, other_scene, changed);
        CHECK_THROWS_WITH(renderer.render({}, {}, resumed.checkpointing()), Catch::Contains(reason));
    };
    Scene moved = scene;
    moved.view.from.x += 1e-3;
    check_refused(moved, small_torus(), "was rendered with another scene, camera or light");
    const std::pair<const char*, std::function<void(TorusSettings&)>> changes[] = {
        {"--size 20x16, not 20x17", [](TorusSettings& s) { s.height = 17; }},
        {"--nodes 2x2x2, not 3x2x2",
         [](TorusSettings& s) {
             s.torus = make_torus({3, 2, 2}, s.links);
         }},
        {"--links torus3d, not torus2d", [](TorusSettings& s) { s.links = Links::kTorus2d; }},
        {"--voxels 2x2x2, not 3x3x3",
         [](TorusSettings& s) {
             s.voxels = {3, 3, 3};
         }},
        {"--inject all, not root", [](TorusSettings& s) { s.inject = Injection::kRoot; }},
        {"--returns rays, not terms", [](TorusSettings& s) { s.packets.one_return_per_ray = false; }},
        {"--packet-words 20, not 21", [](TorusSettings& s) { s.packets.ray_words = 21; }},
        {"--queue 300, not 290", [](TorusSettings& s) { s.queue = 290; }},
        {"--bounces 4, not 8", [](TorusSettings& s) { s.bounces = 8; }},
        {"--sampling centres, not corners", [](TorusSettings& s) { s.sampling = Sampling::kCorners; }},
        {"every Nth pixel, from 1, 0, not 2, 0", [](TorusSettings& s) { s.pixels.stride = 2; }}};
    for (const auto& [reason, change] : changes) {
        TorusSettings changed = small_torus();
        change(changed);
        check_refused(scene, changed, reason);
    }
    TestCheckpointing of_torus(1 << 30, state);
    RingRenderer ring(session, scene, settings_of(RingCase{.width = 20, .height = 16}));
    CHECK_THROWS_WITH(ring.render({}, of_torus.checkpointing()), "was rendered with a machine of type torus, not ring");
}

TEST_CASE("torus: a checkpoint with a valid hash is refused if its counts do not fit the machine",
          "[torus][checkpoint]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    const TorusSettings settings = small_torus();
    const std::string state = stopped_render(session, scene, settings);
    // Sizes of elements: superstep, stalled, reserve, max_live; supersteps, link_words, returns; then status.
    const std::vector<std::size_t> vectors = {4, 4, 4, 8, sizeof(Superstep), 8, sizeof(raya_head)};
    const CheckpointBody saved(state);
    CHECK(saved.bytes() == state);
    CHECK(saved.number<std::uint32_t>(8) == 3);
    const std::size_t link_words_at = saved.vector_at({4, 4, 4, 8, sizeof(Superstep)}),
                      status_at = saved.vector_at(vectors);
    CHECK(saved.number<std::uint64_t>(status_at) == 8 * RAYA_STATUS_WORDS);
    const auto set_status = [&](std::uint32_t word, std::uint32_t value) {
        return [=](CheckpointBody& s) { s.set(status_at + 8 + 4 * (RAYA_STATUS_WORDS + word), value); };
    };
    const std::uint32_t box = buffers_for(settings.queue).box;
    const std::pair<const char*, std::function<void(CheckpointBody&)>> damages[] = {
        {"a superstep more", [](CheckpointBody& s) { s.set(8, 4u); }},
        {"too many stalled supersteps", [](CheckpointBody& s) { s.set(8 + 4 + 8, 3u); }},
        {"an unknown reserve", [](CheckpointBody& s) { s.set(2 * (8 + 4) + 8, 2u); }},
        {"fewer links", [=](CheckpointBody& s) { s.set(link_words_at, s.number<std::uint64_t>(link_words_at) - 1); }},
        {"more status words", [=](CheckpointBody& s) { s.set(status_at, s.number<std::uint64_t>(status_at) + 1); }},
        {"a queue that is too full", set_status(RAYA_STATUS_QUEUE, settings.queue + 1)},
        {"too many returns in the root", set_status(RAYA_STATUS_HOST, settings.queue + 1)},
        {"an outbox that is too full", set_status(RAYA_STATUS_OUTBOX + 5, box + 1)},
        {"an inbox that is too full", set_status(RAYA_STATUS_INBOX, box + 1)},
        {"too many returns in an outbox", set_status(RAYA_STATUS_RETURN_OUTBOX + 1, box + 1)},
        {"too many returns in an inbox", set_status(RAYA_STATUS_RETURN_INBOX + 2, UINT32_MAX)},
        {"one packet more in the queue",
         [=](CheckpointBody& s) {
             const std::size_t at = status_at + 8 + 4 * RAYA_STATUS_QUEUE;
             s.set(at, s.number<std::uint32_t>(at) + 1);
         }},
        {"fewer bytes", [](CheckpointBody& s) { s.body.resize(s.body.size() - 4); }},
        {"more bytes", [](CheckpointBody& s) { s.body += "more"; }}};
    TorusRenderer renderer(session, scene, settings);
    for (const auto& [name, damage] : damages) {
        CAPTURE(name);
        CheckpointBody damaged = saved;
        damage(damaged);
        TestCheckpointing resumed(1 << 30, damaged.bytes());
        CHECK_THROWS_WITH(renderer.render({}, {}, resumed.checkpointing()), "damaged");
    }
    TestCheckpointing resumed(1 << 30, state);
    CHECK(renderer.render({}, {}, resumed.checkpointing()).earlier_s > 0);
    CHECK(renderer.render().earlier_s == 0);
}

}  // namespace raya
