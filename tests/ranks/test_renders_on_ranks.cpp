// Renders distributed over ranks, also if they stop at a checkpoint and resume on another number of ranks: images,
// counts, loads, traffic and packets equal those of a single rank.
#include <catch2/catch.hpp>
#include <numeric>

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

const std::vector<std::string> kScenes = project_scenes(2);

/// Result of a rank. `text`: packets, or the message of a deadlock.
template <class Result>
struct Output {
    Result result;
    std::string text{};
};

/// Calls `render` on `count` ranks; returns rank 0's output.
template <class Render>
auto render_on(std::uint32_t count, const Render& render, const Checkpointing* checkpointing = nullptr) {
    decltype(render(Ranks::single(), nullptr)) first;
    on_ranks(count, [&](Ranks& ranks) {
        auto output = render(ranks, checkpointing);
        if (ranks.is_first())
            first = std::move(output);
        else if (!output.result.image.rgb.empty())
            throw std::logic_error("a rank other than 0 holds an image");
    });
    return first;
}

template <class Result>
void check_same_output(const Output<Result>& single, const Output<Result>& distributed) {
    CHECK(single.text == distributed.text);
    check_same(single.result, distributed.result);
}

/// Checks that render(ranks, checkpointing) gives the same output on a single rank, on several, and with checkpoints:
/// uninterrupted, and stopped twice at random checkpoints. Returns the number of ranks.
template <class Render>
std::uint32_t check_ranks(SplitMix& random, std::uint32_t max_ranks, const Render& render) {
    const auto ranks = [&] { return 1 + random_below(random, std::min(max_ranks, 8u)); };
    const auto single = render(Ranks::single(), nullptr);
    const std::uint32_t count = ranks();
    {
        INFO(count << " ranks");
        check_same_output(single, render_on(count, render));
    }
    TestCheckpointing whole;
    check_same(single.result, render_on(ranks(), render, whole.checkpointing()).result);
    std::string state, history;
    for (int stops = 0; stops < 2 && whole.count() > 2; ++stops) {
        TestCheckpointing part(1 + static_cast<int>(random_below(random, (whole.count() - 1) / 2)), state);
        const std::uint32_t some = ranks();
        history += "stopped on " + std::to_string(some) + " ranks; ";
        CHECK_THROWS_AS(render_on(some, render, part.checkpointing()), Stopped);
        state = part.saved();
    }
    const std::uint32_t last = ranks();
    INFO(history << "ended on " << last << " ranks");
    TestCheckpointing rest(1 << 30, state);
    check_same(single.result, render_on(last, render, rest.checkpointing()).result);
    return count;
}

}  // namespace

TEST_CASE("random rings: image, loads and counts are the same on 1 to 8 ranks", "[ranks][checkpoint]") {
    constexpr std::uint64_t kSeed = 4711;
    SplitMix random(kSeed);
    const AntialiasMethod methods[] = {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample};
    const ExchangeMethod exchanges[] = {ExchangeMethod::kRing, ExchangeMethod::kBus, ExchangeMethod::kBroadcast};
    std::uint32_t several = 0, uneven = 0;
    for (std::uint32_t i = 0; i < quick_cases(24, 200); ++i) {
        const Scene scene = project_scene(kScenes[i % kScenes.size()]), empty_scene;
        RingSettings settings = settings_of(RingCase{.lanes = 4, .group = 1});
        settings.mapping = any_mapping(random, 20);
        settings.antialias.method = methods[random_below(random, 3)];
        settings.antialias.exchange = exchanges[random_below(random, 3)];
        if (settings.mapping.kind == RAYA_RANDOM) settings.antialias = {};  // raya refuses anti-aliasing
        settings.record_costs = true;
        settings.accel.kind = random.next() % 2 ? AccelKind::kNone : AccelKind::kBvh;
        settings.device_pixels = random.next() % 3 ? 1 << 22 : 1 + random_below(random, 60);
        if (random.next() % 4 == 0) settings.machine.pe_memory_bytes = std::uint64_t{1} << 20;
        const std::uint32_t pes = settings.mapping.pes;
        if (settings.accel.kind == AccelKind::kNone) settings.split = std::gcd(pes, 6u);
        CAPTURE(kSeed, i, scene.name, pes, settings.split, settings.mapping.width, settings.mapping.height,
                settings.mapping.kind);
        const std::uint32_t count = check_ranks(random, pes, [&](Ranks& ranks, const Checkpointing* checkpointing) {
            Session session(choose_device(""));
            RingSettings own_settings = settings;
            if (ranks.rank() == 2) own_settings.kernels.lanes = 1;  // ranks may differ in lanes
            RingRenderer renderer(session, ranks.is_first() ? scene : empty_scene, own_settings, ranks);
            return Output<RingResult>{renderer.render({}, checkpointing)};
        });
        several += count > 1;
        uneven += pes % count != 0;
    }
    CHECK(several > 10);
    CHECK(uneven > 5);
}

TEST_CASE("random toruses: image, traffic and packets, or the deadlock, are the same on 1 to 8 ranks",
          "[ranks][checkpoint]") {
    constexpr std::uint64_t kSeed = 77;
    SplitMix random(kSeed);
    std::uint32_t several = 0;
    for (std::uint32_t i = 0; i < quick_cases(20, 150); ++i) {
        const Scene scene = project_scene(kScenes[i % kScenes.size()]), empty_scene;
        TorusCase c{.width = 12, .height = 10, .group = 1};
        c.nodes = random_sides(random, 3);
        for (std::size_t axis = 0; axis < 3; ++axis)
            c.voxels[axis] = random.next() % 2 ? c.nodes[axis] : 1 + random_below(random, 7);
        c.links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
        c.inject = random.next() % 2 ? Injection::kAll : Injection::kRoot;
        c.packets = random_charge(random);
        // With a short queue, packets wait in the mailboxes.
        c.queue = random.next() % 2 ? 0 : raya_min_queue(lights_of(scene), c.bounces) + random_below(random, 100);
        const TorusSettings settings = settings_of(c);
        CAPTURE(kSeed, i, scene.name, case_text(c));
        several +=
            check_ranks(random, raya_nodes(settings.torus), [&](Ranks& ranks, const Checkpointing* checkpointing) {
                Session session(choose_device(""));
                Output<TorusResult> output;
                TorusRenderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
                RenderObservers observers;
                if (checkpointing == nullptr)
                    observers.packets = [&](const PacketRecord& r) {
                        output.text += fmt::format("{} {} {} {} {:x} {:x}\n", r.superstep, r.source, r.destination,
                                                   r.words, r.head.pixel, r.head.state);
                    };
                try {
                    output.result = renderer.render({}, observers, checkpointing);
                } catch (const TorusDeadlock& deadlock) {
                    output.text += deadlock.what();
                }
                return output;
            }) > 1;
    }
    CHECK(several > 8);
}

TEST_CASE("a rank's device holds only the data of the rank's own PEs or nodes", "[ranks]") {
    const Scene scene = project_scene("spheres"), empty_scene;
    RingSettings ring = settings_of(RingCase{.width = 256, .height = 256, .pes = 64, .offset = 0});
    ring.antialias.method = AntialiasMethod::kFilter;
    const TorusSettings torus = settings_of(TorusCase{.nodes = {4, 4, 4}, .queue = 400});
    const auto max_bytes = [&]<class Renderer>(std::uint32_t count, const auto& settings, Renderer*) {
        std::vector<double> bytes(count);
        on_ranks(count, [&](Ranks& ranks) {
            Session session(choose_device(""));
            const Renderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
            bytes[ranks.rank()] = static_cast<double>(session.bytes_taken());
        });
        return *std::max_element(bytes.begin(), bytes.end());
    };
    constexpr RingRenderer* kRing = nullptr;
    constexpr TorusRenderer* kTorus = nullptr;
    // Every rank of a ring also holds the scene. Every rank of a torus also holds an inbox for each link from another
    // rank.
    CHECK(max_bytes(4, ring, kRing) < max_bytes(1, ring, kRing) / 3.5);
    CHECK(max_bytes(4, torus, kTorus) < max_bytes(1, torus, kTorus) / 2.9);
}

}  // namespace raya
