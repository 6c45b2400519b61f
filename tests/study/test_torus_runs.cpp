// Renders for the studies of the torus machine: what they must have in common, and the scenes that studies make.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/cl/device.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/spread.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 13;

LabelledScene small_scene(int spheres, unsigned seed) { return {"small", generate_random(spheres, seed)}; }

// What no distribution may change.
void check_same_rays(const TorusRun& run, const TorusRun& other) {
    for (const int event : {RAYA_PRIMARY, RAYA_PRIMARY_HITS, RAYA_REFLECTED, RAYA_REFRACTED, RAYA_SHADOW,
                            RAYA_SHADOW_HITS, RAYA_SHADED, RAYA_LIT})
        CHECK(run.result.events[event] == other.result.events[event]);
    CHECK(run.result.made == other.result.made);
    CHECK(run.rays() == other.rays());
    CHECK(run.packets() == other.packets());
}

void check_root(const TorusRun& run) {
    CHECK(run.root_ms() <= run.time.overlapped_ms);
    CHECK(run.root_link_ms <= run.time.links_ms);
    CHECK(run.root_processor_ms <= run.time.processor_ms);
    CHECK(run.time.overlapped_ms <= run.time.stepwise_ms * (1 + 1e-12));  // sums of many steps, rounded
    if (run.nodes() > 1) return;
    CHECK(run.result.hops == 0);
    CHECK(run.busiest_link_bytes() == 0);
    CHECK(run.root_ms() == run.time.overlapped_ms);
    CHECK(run.time.overlapped_ms == Approx(run.time.stepwise_ms).epsilon(1e-12));
}

TEST_CASE("near_cube's sides are powers of two, as alike as can be", "[study]") {
    for (std::uint32_t count = 1; count <= 1u << 24; count *= 2) {
        const auto sides = near_cube(count);
        CHECK(sides[0] * sides[1] * sides[2] == count);
        CHECK((sides[0] >= sides[1] && sides[1] >= sides[2] && sides[2] * 2 >= sides[0]));
    }
    // The paper's divisions.
    CHECK(near_cube(32) == Divisions{4, 4, 2});
    CHECK(near_cube(256) == Divisions{8, 8, 4});
    CHECK(near_cube(1024) == Divisions{16, 8, 8});
    CHECK(near_cube(4096) == std::array<std::uint32_t, 3>{16, 16, 16});
    for (const std::uint32_t odd : {0u, 3u, 12u}) CHECK_THROWS_AS(near_cube(odd), std::invalid_argument);
}

TEST_CASE("the same rays are traced on any number of nodes, links and injection", "[study]") {
    Session session(choose_device(""));
    constexpr unsigned kSeed = 5;
    std::mt19937 random(kSeed);
    const LabelledScene scene = small_scene(30, kSeed);
    const TorusRun one = run_on_torus(session, scene, kSize, {});
    check_root(one);
    for (int i = 0; i < 3; ++i) {  // each builds its kernels: 2, 8 and 16 nodes
        TorusPlan plan;
        plan.nodes = near_cube(i == 0 ? 2 : 4u << i);
        plan.voxels = near_cube(1u << random() % 8);
        plan.links = i == 1 ? Links::kTorus2d : Links::kTorus3d;
        plan.inject = i == 2 ? Injection::kAll : Injection::kRoot;
        CAPTURE(kSeed, i, sides_text(plan.nodes), sides_text(plan.voxels));
        const TorusRun run = run_on_torus(session, scene, kSize, plan);
        check_same_rays(run, one);
        check_root(run);
        CHECK(run.plan.queue == 0);
        CHECK(run.bytes_without_buffers() < run.result.node_bytes);
    }
}

TEST_CASE("a queue too short is made longer until the machine comes to an end", "[study]") {
    Session session(choose_device(""));
    const LabelledScene scene = small_scene(20, 3);
    TorusPlan plan;
    plan.nodes = plan.voxels = {2, 2, 1};
    plan.queue = 1;  // less than a hit can ask for
    const TorusRun run = run_on_torus(session, scene, kSize, plan);
    CHECK(run.plan.queue > 1);
    CHECK(run.result.buffers.queue == run.plan.queue);
    CHECK(std::has_single_bit(run.plan.queue));
    plan.queue = 0;
    check_same_rays(run, run_on_torus(session, scene, kSize, plan));
}

TEST_CASE("groups render what one machine renders", "[study]") {
    Session session(choose_device(""));
    const LabelledScene scene = small_scene(40, 7);
    TorusPlan plan;
    plan.voxels = {2, 2, 2};
    const TorusRun one = run_on_torus(session, scene, kSize, plan);
    for (const std::uint32_t groups : {1u, 4u, 8u}) {
        CAPTURE(groups);
        plan.nodes = near_cube(8 / groups);
        const std::vector<TorusRun> runs = run_groups(session, scene, kSize, plan, groups);
        REQUIRE(runs.size() == groups);
        EventCounts events{};
        for (std::uint32_t g = 0; g < groups; ++g) {
            CHECK(runs[g].result.made[RAYA_KIND_PRIMARY] == (kSize * kSize - g - 1) / groups + 1);
            check_root(runs[g]);
            for (std::size_t i = 0; i < events.size(); ++i) events[i] += runs[g].result.events[i];
        }
        EventCounts expected = one.result.events;
        CHECK(events[RAYA_DISCARDED] >= std::exchange(expected[RAYA_DISCARDED], events[RAYA_DISCARDED]));
        CHECK(events == expected);  // tests and steps too: the voxels are the same
    }
}

TEST_CASE("random spheres are the even scene's, inside the cube, and within their voxels where they are moved",
          "[study]") {
    for (int i = 0; i < 100; ++i) {
        const int count = 1 + i * i % 700;
        CAPTURE(i, count);
        const Scene even = even_scene(count).scene, random = scattered(even, static_cast<std::uint64_t>(i)),
                    within = moved_within(random);
        REQUIRE(random.spheres.size() == even.spheres.size());
        for (std::size_t s = 0; s < even.spheres.size(); ++s) {
            const double radius = even.spheres[s].radius;
            CHECK(random.spheres[s].radius == radius);
            CHECK(random.spheres[s].surface == even.spheres[s].surface);
            for (int axis = 0; axis < 3; ++axis) {
                const double at = random.spheres[s].centre[axis], moved = within.spheres[s].centre[axis];
                REQUIRE(std::abs(at) <= 1 - radius);
                const double voxel = std::min(3.0, std::floor((at + 1) * 2));
                REQUIRE((moved + 1 - radius) * 2 >= voxel);
                REQUIRE((moved + 1 + radius) * 2 <= voxel + 1);
                REQUIRE(std::abs(moved - at) <= radius + 1.0 / 32);
            }
        }
    }
}

TEST_CASE("the outermost spheres touch the sides of the cube", "[study]") {
    for (const int count : {1, 5, 64, 300}) {
        const Scene scene = touching_walls(even_scene(count).scene);
        for (int axis = 0; axis < 3 && count > 1; ++axis) {
            double low = 0, high = 0;
            for (const Sphere& sphere : scene.spheres) {
                low = std::min(low, sphere.centre[axis] - sphere.radius);
                high = std::max(high, sphere.centre[axis] + sphere.radius);
            }
            CHECK(low == -1);
            CHECK(high == 1);
        }
    }
}

}  // namespace
}  // namespace raya
