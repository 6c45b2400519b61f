// The device memory of a rank holds only the data of the rank's own PEs or nodes.
#include <catch2/catch.hpp>
#include <mutex>

#include "host/torus/torus_plan.hpp"
#include "tests/ranks/thread_ranks.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

/// By rank: the bytes that a render allocates on the rank's device.
template <class Renderer, class Settings>
std::vector<std::uint64_t> bytes_of_ranks(std::uint32_t count, const Scene& scene, const Settings& settings) {
    std::vector<std::uint64_t> bytes(count);
    on_ranks(count, [&](Ranks& ranks) {
        Session session(choose_device(""));
        const Scene nothing;
        const Renderer renderer(session, ranks.first() ? scene : nothing, settings, ranks);
        bytes[ranks.rank()] = session.bytes_taken();
    });
    return bytes;
}

}  // namespace

TEST_CASE("a rank holds only its own nodes' words, equal to those of a single rank", "[ranks]") {
    constexpr std::uint64_t kSeed = 31;
    SplitMix random(kSeed);
    for (int i = 0; i < 40; ++i) {
        TorusCase c;
        c.nodes = {1 + random_below(random, 4), 1 + random_below(random, 4), 1 + random_below(random, 4)};
        const TorusSettings settings = settings_of(c);
        const Scene scene = project_scene(project_scenes()[i % project_scenes().size()]);
        const std::uint32_t nodes = raya_nodes(settings.torus), count = 1 + random_below(random, std::min(nodes, 8u));
        CAPTURE(kSeed, i, case_text(c), count);
        Session session(choose_device(""));
        const DeviceMemory memory = smallest_device_memory(session.device(), Ranks::alone());
        const TorusJob all =
            make_torus_job(session, scene, settings, NodeShare(settings.torus), memory, Ranks::alone());
        std::vector<TorusJob> jobs(count, all);
        on_ranks(count, [&](Ranks& ranks) {
            const NodeShare share(settings.torus, count, ranks.rank());
            const Scene nothing;
            jobs[ranks.rank()] =
                make_torus_job(session, ranks.first() ? scene : nothing, settings, share, memory, ranks);
        });
        for (std::uint32_t rank = 0; rank < count; ++rank) {
            const NodeShare share(settings.torus, count, rank);
            const NodeMemories& own = jobs[rank].memories;
            REQUIRE(own.starts.size() == share.nodes() + 1);
            CHECK(own.words.size() == own.starts.back());
            bool same = true;
            for (std::uint32_t slot = 0; slot < share.nodes(); ++slot) {
                const std::uint32_t node = share.own_nodes()[slot];
                const auto from = all.memories.words.begin() + all.memories.starts[node];
                const auto end = all.memories.words.begin() + all.memories.starts[node + 1];
                same &= std::equal(from, end, own.words.begin() + own.starts[slot],
                                   own.words.begin() + own.starts[slot + 1]);
            }
            CHECK(same);
            CHECK(jobs[rank].words == all.words);
            CHECK(jobs[rank].fullest_words == all.fullest_words);
            CHECK(jobs[rank].buffers.queue == all.buffers.queue);
        }
    }
}

TEST_CASE("torus: a rank's device holds its share of the nodes, plus an inbox for each link from another rank",
          "[ranks]") {
    const TorusSettings settings = settings_of(TorusCase{.nodes = {4, 4, 4}, .queue = 400});
    const Scene scene = project_scene("spheres");
    const std::uint64_t all = bytes_of_ranks<TorusRenderer>(1, scene, settings).front();
    for (const std::uint32_t count : {2u, 4u, 8u}) {
        const std::vector<std::uint64_t> of_ranks = bytes_of_ranks<TorusRenderer>(count, scene, settings);
        for (std::uint32_t rank = 0; rank < count; ++rank) {
            const NodeShare share(settings.torus, count, rank);
            // Mailboxes take nearly all memory of these nodes, and half of the mailboxes are inboxes. A rank also holds
            // an inbox for each link that enters its nodes from another rank.
            const double inboxes = static_cast<double>(share.inboxes()) / share.nodes();
            CAPTURE(count, rank, all, of_ranks[rank], inboxes);
            CHECK(static_cast<double>(of_ranks[rank]) < 1.05 * static_cast<double>(all) / count * (1 + inboxes) / 2);
        }
    }
}

TEST_CASE("ring: a rank's device holds the scene and its own PEs' pixels", "[ranks]") {
    RingSettings settings = settings_of(RingCase{.width = 256, .height = 256, .pes = 64, .offset = 0});
    settings.antialias.method = AntialiasMethod::kFilter;
    const Scene scene = project_scene("spheres");
    Session session(choose_device(""));
    const std::uint64_t words = 4 * make_ring_job(session, scene, settings, Ranks::alone()).job.words().size();
    const std::uint64_t all = bytes_of_ranks<RingRenderer>(1, scene, settings).front() - words;
    for (const std::uint32_t count : {2u, 4u, 8u})
        for (const std::uint64_t bytes : bytes_of_ranks<RingRenderer>(count, scene, settings)) {
            CAPTURE(count, words, all, bytes);
            CHECK(static_cast<double>(bytes - words) < 1.02 * static_cast<double>(all) / count);
        }
}

}  // namespace raya
