// Two charges of the time model: the cost of discarded rays, and the words of one return per ray, although the device
// sends one return per term.
#include <catch2/catch.hpp>
#include <map>
#include <tuple>

#include "host/torus/torus_plan.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/record_packets.hpp"

namespace raya {
namespace {

// Returns the number of pixels in all windows, which is also the number of discarded rays. Each node makes the rays of
// the pixels in its window and in its rows of the image. The rows of all nodes contain every pixel once, and all nodes
// together keep one ray per pixel.
std::uint64_t pixels_of_windows(const Scene& scene, const TorusSettings& s) {
    const PackedJob job = pack_job(scene, job_settings(s, length_scale(scene, s.format)));
    std::uint64_t pixels = 0;
    for (const PixelWindow& w : pixel_windows(job.header(), partition(job, s.format, s.voxels).grid, s.torus, s.format))
        for (std::uint32_t row = w.rows[0]; row < w.rows[1]; ++row)
            for (std::uint32_t column = w.columns[0]; column < w.columns[1]; ++column)
                pixels += (row * s.width + column) % s.pixels.stride == s.pixels.first;
    return pixels;
}

using RayKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // pixel, path, level
RayKey key_of(const PacketRecord& p) { return {p.head.pixel, p.head.path, raya_state_level(state_of(p))}; }

// Checks that each ray has at most one return. The return must leave from the node in which the ray's last shadow ray
// ends: the ray to the last light that the surface faces.
void check_last_lights(const RecordedRender& r) {
    std::map<RayKey, PacketRecord> last_records;  // by ray: last record of its last shadow ray
    for (const PacketRecord& p : r.records) {
        if (kind_of(p) != RAYA_KIND_SHADOW) continue;
        PacketRecord& known = last_records.emplace(key_of(p), p).first->second;
        if (raya_state_light(state_of(p)) >= raya_state_light(state_of(known))) known = p;
    }
    std::size_t early_returns = 0, misplaced_returns = 0, repeated_returns = 0;
    std::map<RayKey, int> returns;
    for (const PacketRecord& p : r.records) {
        if (kind_of(p) != RAYA_KIND_RETURN) continue;
        repeated_returns += ++returns[key_of(p)] > 1;
        const auto shadow = last_records.find(key_of(p));
        if (shadow == last_records.end()) continue;
        const std::uint32_t light = raya_state_light(state_of(shadow->second));
        early_returns += raya_state_light(state_of(p)) < light;
        misplaced_returns += raya_state_light(state_of(p)) == light && p.source != shadow->second.destination;
    }
    CHECK(early_returns == 0);
    CHECK(misplaced_returns == 0);
    CHECK(repeated_returns == 0);
}

}  // namespace

TEST_CASE("nodes discard one ray per pixel of their windows; a root that makes all rays discards none",
          "[torus][slow]") {
    const std::uint64_t seed = 662;
    SplitMix random(seed);
    Session session(choose_device(""));
    std::uint64_t discarded = 0;
    for (unsigned i = 0; i < quick_cases(8, 40); ++i) {
        const Scene scene = random_view_scene(kSceneSeeds[i % kSceneSeeds.size()]);
        TorusCase c{.width = 1 + random_below(random, 30), .height = 1 + random_below(random, 30), .bounces = 0};
        c.lanes = i % 2 ? 4 : 1;
        c.group = 1 + i % 3;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            c.nodes[axis] = 1 + random_below(random, 3);
            c.voxels[axis] = 1 + random_below(random, 7);
        }
        c.pixels.stride = 1 + random_below(random, 3);
        c.pixels.first = random_below(random, c.pixels.stride);
        c.inject = i % 4 == 3 ? Injection::kRoot : Injection::kAll;
        if (i % 3 == 0) c.queue = 20 * raya_min_queue(lights_of(scene), c.bounces);
        CAPTURE(seed, i, case_text(c));
        const TorusSettings s = settings_of(c);
        const EventCounts e = render_torus(session, scene, c).events;
        const bool by_root = c.inject == Injection::kRoot || raya_nodes(s.torus) == 1;
        CHECK(e[RAYA_DISCARDED] == (by_root ? 0 : pixels_of_windows(scene, s)));
        discarded += e[RAYA_DISCARDED];
    }
    CHECK(discarded > 1000);
}

TEST_CASE("one return per ray: the return leaves from the node in which the last shadow ray ends", "[torus]") {
    const std::uint64_t seed = 81;
    SplitMix random(seed);
    Session session(choose_device(""));
    std::uint64_t added_returns = 0;
    for (unsigned i = 0; i < quick_cases(6, 30); ++i) {
        const Scene scene = random_view_scene(kSceneSeeds[i % kSceneSeeds.size()]);
        TorusCase c{.width = 16, .height = 12, .nodes = {3, 2, 2}, .group = 1 + i % 2};
        c.packets = {22, true};
        if (i % 2) c.queue = 6 * raya_min_queue(lights_of(scene), c.bounces);
        CAPTURE(seed, i, case_text(c));
        const RecordedRender r = render_and_record(session, scene, c);
        check_last_lights(r);
        TorusCase per_term = c;
        per_term.packets = {};
        const TorusResult per_term_result = render_torus(session, scene, per_term);
        CHECK(image_and_counts(r.result) == image_and_counts(per_term_result));
        CHECK(r.result.returns < per_term_result.returns);
        CHECK(r.result.contributions >= per_term_result.contributions);
        added_returns += r.result.contributions - per_term_result.contributions;
    }
    CHECK(added_returns > 100);  // number of returns that blocked last shadow rays send
}

}  // namespace raya
