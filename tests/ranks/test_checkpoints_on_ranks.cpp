// A render on several ranks that stops at a checkpoint and resumes, on the same or another number of ranks, gives the
// same image and counts as a render on one rank.
#include <catch2/catch.hpp>

#include "host/torus/topology.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/base/test_checkpointing.hpp"
#include "tests/ranks/same_results.hpp"
#include "tests/ranks/thread_ranks.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/ring/small_mapping.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

/// Runs `render` on `count` ranks until it has saved `saves` checkpoints, from the checkpoint `resumed` on. Returns the
/// last checkpoint.
template <class Render>
std::string stop_on(std::uint32_t count, int saves, const std::string& resumed, const Render& render) {
    TestCheckpointing checkpointing(saves, resumed);
    CHECK_THROWS_AS(on_ranks(count, [&](Ranks& ranks) { render(ranks, checkpointing.checkpointing()); }), Stopped);
    return checkpointing.saved();
}

/// Runs `render` on `count` ranks to its end. Returns rank 0's result and all checkpoints.
template <class Render>
auto finish_on(std::uint32_t count, const std::string& resumed, const Render& render) {
    TestCheckpointing checkpointing(1 << 30, resumed);
    std::pair<decltype(render(Ranks::single(), nullptr)), std::vector<std::string>> finished;
    on_ranks(count, [&](Ranks& ranks) {
        auto own_result = render(ranks, checkpointing.checkpointing());
        if (ranks.is_first()) finished.first = std::move(own_result);
    });
    finished.second = checkpointing.all();
    return finished;
}

/// Stops `render` at random checkpoints, and at the first checkpoint that fulfils each of `conditions`. Each render may
/// stop twice and uses other numbers of ranks. Checks that the resumed render gives the result of a single rank without
/// checkpoints.
template <class Render>
void check_stops(SplitMix& random, const Render& render,
                 const std::vector<std::function<bool(const std::string&)>>& conditions = {}) {
    const auto single = render(Ranks::single(), nullptr);
    const auto [uninterrupted, states] = finish_on(3, "", render);
    check_same(single, uninterrupted);
    REQUIRE(states.size() > 3);
    std::vector<int> stops;
    for (const auto& condition : conditions) {
        const auto found = std::find_if(states.begin(), states.end(), condition);
        REQUIRE(found != states.end());
        stops.push_back(1 + static_cast<int>(found - states.begin()));
    }
    const auto saves = static_cast<std::uint32_t>(states.size());
    for (std::uint32_t i = 0; i < quick_cases(3, 20); ++i)
        stops.push_back(1 + static_cast<int>(random_below(random, saves - 1)));
    for (const int stop : stops) {
        const std::uint32_t first = 1 + random_below(random, 4), second = 1 + random_below(random, 4),
                            last = 1 + random_below(random, 4);
        CAPTURE(first, second, last, stop, saves);
        std::string state = stop_on(first, stop, "", render);
        if (random.next() % 2 && stop + 1 < static_cast<int>(saves)) state = stop_on(second, 1, state, render);
        const auto [resumed, more_states] = finish_on(last, state, render);
        check_same(single, resumed);
        CHECK(more_states.size() < states.size());
    }
}

/// Returns true if a node of the checkpoint has status `word`, or one of the next `words` - 1, above 0.
bool any_status(const std::string& bytes, const TorusSettings& settings, std::uint32_t word, std::uint32_t words) {
    const std::uint32_t nodes = raya_nodes(settings.torus);
    const CheckpointBody state(bytes);
    // Vectors before the status: superstep, stalled, reserve, max_live, supersteps, link_words, returns.
    const std::size_t status_at = state.vector_at({4, 4, 4, 8, sizeof(Superstep), 8, sizeof(raya_head)}) + 8;
    NodeStatus status(nodes);
    for (std::size_t i = 0; i < status.words.size(); ++i)
        status.words[i] = state.number<std::uint32_t>(status_at + 4 * i);
    for (std::uint32_t node = 0; node < nodes; ++node)
        for (std::uint32_t i = 0; i < words; ++i)
            if (status.at(node, word + i) > 0) return true;
    return false;
}

}  // namespace

TEST_CASE("rings: a render stopped at any band resumes on any number of ranks", "[ranks][checkpoint]") {
    constexpr std::uint64_t kSeed = 36;
    SplitMix random(kSeed);
    const Scene scene = project_scene("planes"), empty_scene;
    const std::pair<AntialiasMethod, std::uint64_t> cases[] = {
        {AntialiasMethod::kNone, 500}, {AntialiasMethod::kFilter, 1 << 22}, {AntialiasMethod::kSupersample, 1 << 22}};
    for (const auto& [method, device_pixels] : cases) {
        CAPTURE(kSeed, antialias_name(method));
        RingSettings settings = settings_of(
            {.width = 50, .height = 37, .pes = 7, .machine = "grande", .lanes = 4, .group = 1, .bounces = 3});
        settings.record_costs = true;
        settings.antialias.method = method;
        settings.device_pixels = device_pixels;
        check_stops(random, [&](Ranks& ranks, const Checkpointing* checkpointing) {
            Session session(choose_device(""));
            RingSettings own_settings = settings;
            if (ranks.rank() == 2) own_settings.kernels.lanes = 1;  // ranks may differ in lanes
            RingRenderer renderer(session, ranks.is_first() ? scene : empty_scene, own_settings, ranks);
            return renderer.render({}, checkpointing);
        });
    }
}

TEST_CASE("toruses: a render stopped in any superstep resumes on any number of ranks", "[ranks][checkpoint]") {
    constexpr std::uint64_t kSeed = 37;
    SplitMix random(kSeed);
    const Scene empty_scene;
    const std::pair<const char*, TorusCase> cases[] = {
        {"glass", {.nodes = {3, 2, 2}, .voxels = {4, 3, 2}, .queue = 100, .group = 1}},
        // A short queue, so that packets wait in the mailboxes; one return for each ray.
        {"mirrors", {.packets = {20, true}, .queue = 30, .group = 1}}};
    for (const auto& [name, torus_case] : cases) {
        CAPTURE(kSeed, name);
        const Scene scene = project_scene(name);
        const TorusSettings settings = settings_of(torus_case);
        std::vector<std::function<bool(const std::string&)>> conditions;
        if (settings.queue == 30)
            for (const std::uint32_t boxes :
                 {RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX, RAYA_STATUS_RETURN_OUTBOX, RAYA_STATUS_RETURN_INBOX})
                conditions.push_back([&settings, boxes](const std::string& bytes) {
                    return any_status(bytes, settings, boxes, RAYA_LINKS);
                });
        const auto render = [&](Ranks& ranks, const Checkpointing* checkpointing) {
            Session session(choose_device(""));
            TorusRenderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
            return renderer.render({}, {}, checkpointing);
        };
        check_stops(random, render, conditions);
    }
}

}  // namespace raya
