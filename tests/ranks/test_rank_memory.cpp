// The device of a rank holds only the data of the rank's own PEs or nodes.
#include <catch2/catch.hpp>
#include <mutex>

#include "host/torus/torus_plan.hpp"
#include "tests/ranks/thread_ranks.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

/// Returns [rank]: number of bytes that a render allocates on the rank's device.
template <class Renderer, class Settings>
std::vector<std::uint64_t> bytes_of_ranks(std::uint32_t count, const Scene& scene, const Settings& settings) {
    std::vector<std::uint64_t> bytes(count);
    on_ranks(count, [&](Ranks& ranks) {
        Session session(choose_device(""));
        const Scene empty_scene;
        const Renderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
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
        const DeviceMemory memory = smallest_device_memory(session.device(), Ranks::single());
        const TorusJob whole_job =
            make_torus_job(session, scene, settings, NodeDistribution(settings.torus), memory, Ranks::single());
        std::vector<TorusJob> jobs(count, whole_job);
        on_ranks(count, [&](Ranks& ranks) {
            const NodeDistribution distribution(settings.torus, ranks);
            const Scene empty_scene;
            jobs[ranks.rank()] =
                make_torus_job(session, ranks.is_first() ? scene : empty_scene, settings, distribution, memory, ranks);
        });
        for (std::uint32_t rank = 0; rank < count; ++rank) {
            Ranks ranks = silent_rank(rank, count);
            const NodeDistribution distribution(settings.torus, ranks);
            const NodeMemories& own_memories = jobs[rank].memories;
            REQUIRE(own_memories.starts.size() == distribution.count() + 1);
            CHECK(own_memories.words.size() == own_memories.starts.back());
            bool same = true;
            for (std::uint32_t slot = 0; slot < distribution.count(); ++slot) {
                const std::uint32_t node = distribution.own()[slot];
                const auto first = whole_job.memories.words.begin() + whole_job.memories.starts[node];
                const auto end = whole_job.memories.words.begin() + whole_job.memories.starts[node + 1];
                same &= std::equal(first, end, own_memories.words.begin() + own_memories.starts[slot],
                                   own_memories.words.begin() + own_memories.starts[slot + 1]);
            }
            CHECK(same);
            CHECK(jobs[rank].fullest_words == whole_job.fullest_words);
            CHECK(jobs[rank].buffers.queue == whole_job.buffers.queue);
        }
    }
}

TEST_CASE("torus: a rank's device holds the rank's nodes, plus an inbox for each link from another rank", "[ranks]") {
    const TorusSettings settings = settings_of(TorusCase{.nodes = {4, 4, 4}, .queue = 400});
    const Scene scene = project_scene("spheres");
    const std::uint64_t single_bytes = bytes_of_ranks<TorusRenderer>(1, scene, settings).front();
    for (const std::uint32_t count : {2u, 4u, 8u}) {
        const std::vector<std::uint64_t> rank_bytes = bytes_of_ranks<TorusRenderer>(count, scene, settings);
        for (std::uint32_t rank = 0; rank < count; ++rank) {
            Ranks ranks = silent_rank(rank, count);
            const NodeDistribution distribution(settings.torus, ranks);
            // Mailboxes take nearly all memory of these nodes. On a single rank, half of the mailboxes are inboxes.
            // With several ranks, each rank also holds an inbox for each link that enters its nodes from another rank.
            const double inboxes_per_node = static_cast<double>(distribution.inboxes()) / distribution.count();
            CAPTURE(count, rank, single_bytes, rank_bytes[rank], inboxes_per_node);
            CHECK(static_cast<double>(rank_bytes[rank]) <
                  1.05 * static_cast<double>(single_bytes) / count * (1 + inboxes_per_node) / 2);
        }
    }
}

TEST_CASE("ring: a rank's device holds the scene and its own PEs' pixels", "[ranks]") {
    RingSettings settings = settings_of(RingCase{.width = 256, .height = 256, .pes = 64, .offset = 0});
    settings.antialias.method = AntialiasMethod::kFilter;
    const Scene scene = project_scene("spheres");
    Session session(choose_device(""));
    const std::uint64_t job_bytes = 4 * make_ring_job(session, scene, settings, Ranks::single()).job.words().size();
    const std::uint64_t single_bytes = bytes_of_ranks<RingRenderer>(1, scene, settings).front() - job_bytes;
    for (const std::uint32_t count : {2u, 4u, 8u})
        for (const std::uint64_t bytes : bytes_of_ranks<RingRenderer>(count, scene, settings)) {
            CAPTURE(count, job_bytes, single_bytes, bytes);
            CHECK(static_cast<double>(bytes - job_bytes) < 1.02 * static_cast<double>(single_bytes) / count);
        }
}

}  // namespace raya
