// Conservation of packets on random machines: numbers of packets, hops and words on links, routes of rays, returns and
// discarded rays.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <numeric>
#include <tuple>

#include "host/torus/torus_plan.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

std::uint32_t kind_of(const PacketRecord& p) { return raya_state_kind(p.head.state); }

std::uint64_t sum(const std::vector<std::uint64_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

// Identifies a ray: pixel, path, level.
using RayKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
RayKey key_of(const PacketRecord& p) { return {p.head.pixel, p.head.path, raya_state_level(p.head.state)}; }

// Checks that the number of packets of each kind follows from the events.
void check_kinds(const TorusResult& r, std::uint64_t pixels, std::uint32_t lights, bool one_return_per_ray) {
    const EventCounts& e = r.events;
    CHECK(r.made == r.ended);
    CHECK(r.made[RAYA_KIND_NONE] == 0);
    CHECK(r.made[RAYA_KIND_PRIMARY] == pixels);
    CHECK(e[RAYA_PRIMARY] == pixels);
    CHECK(r.made[RAYA_KIND_REFLECTED] == e[RAYA_REFLECTED]);
    CHECK(r.made[RAYA_KIND_REFRACTED] == e[RAYA_REFRACTED]);
    CHECK(r.made[RAYA_KIND_SHADOW] == e[RAYA_SHADOW]);
    CHECK(e[RAYA_SHADOW] == e[RAYA_SHADOW_HITS] + e[RAYA_LIT]);
    // Every ray returns an ambient term or the background, and each unblocked light adds a term. If one return carries
    // all terms of a ray, the ray's last shadow ray sends that return even if this shadow ray is blocked. With one
    // light, each shadow ray is the last one of its ray.
    const std::uint64_t rays = pixels + e[RAYA_REFLECTED] + e[RAYA_REFRACTED], terms = rays + e[RAYA_LIT];
    const std::uint64_t blocked_rays = one_return_per_ray ? e[RAYA_SHADOW_HITS] : 0;
    CHECK(r.returns == (one_return_per_ray ? rays : terms));
    CHECK(r.made[RAYA_KIND_RETURN] >= terms + (lights > 1 ? 0 : blocked_rays));
    CHECK(r.made[RAYA_KIND_RETURN] <= terms + blocked_rays);
}

// Checks that each packet crosses as many links as its route has, and that each link carries the number of words that
// follows from the routing rules.
void check_traffic(const TorusResult& result, const std::vector<PacketRecord>& records, const TorusSettings& s) {
    std::uint64_t hops = 0;
    std::vector<std::uint64_t> words(result.link_words.size());
    std::size_t to_itself = 0, wrong_words = 0;
    for (const PacketRecord& p : records) {
        const std::uint64_t links = add_route(words, s.torus, p);
        to_itself += links == 0;
        hops += links;
        wrong_words += p.words != (kind_of(p) == RAYA_KIND_RETURN ? s.packets.return_words() : s.packets.ray_words);
    }
    CHECK(to_itself == 0);
    CHECK(wrong_words == 0);
    CHECK(result.hops == hops);
    CHECK(sum(result.link_packets) == hops);
    CHECK(result.link_words == words);
    CHECK(std::is_sorted(records.begin(), records.end(), [](const PacketRecord& a, const PacketRecord& b) {
        return std::tie(a.superstep, a.source) < std::tie(b.superstep, b.source);
    }));
    std::uint64_t step_cycles = 0, step_words = 0;  // sums of the supersteps' maxima
    for (const Superstep& step : result.supersteps) {
        step_cycles += step.max_node_cycles;
        step_words += step.max_link_words;
    }
    CHECK((step_cycles >= result.load.max && step_cycles <= sum(result.load.per_pe)));
    CHECK((step_words >= *std::ranges::max_element(words) && step_words <= sum(words)));
    const TorusTime time = torus_time(s.torus, result);
    CHECK(time.overlapped_ms == std::max(time.processor_ms, time.links_ms));
    CHECK(time.overlapped_ms <= time.stepwise_ms * (1 + 1e-12));
}

// Checks that each stage of a ray's route starts, in a later superstep, where the previous stage ended. Returns the
// number of rays that visit all voxels in turn (wide rays).
std::size_t check_routes(const std::vector<PacketRecord>& records) {
    std::map<std::pair<RayKey, std::uint32_t>, PacketRecord> last;  // by ray and light
    std::size_t interrupted = 0, wide = 0;
    for (const PacketRecord& p : records) {
        if (kind_of(p) == RAYA_KIND_RETURN) continue;
        const auto [before, is_new] = last.emplace(std::pair(key_of(p), raya_state_light(p.head.state)), p);
        wide += is_new && p.head.state & RAYA_STATE_WIDE;
        interrupted += !is_new && (before->second.destination != p.source || before->second.superstep >= p.superstep);
        before->second = p;
    }
    CHECK(interrupted == 0);
    return wide;
}

// Checks that every return goes to the root, once for each term or, if all terms of a ray are in one return, once for
// each ray. That return leaves from the node in which the ray's last shadow ray ends: that to the last light.
void check_returns(const std::vector<PacketRecord>& records, bool one_return_per_ray) {
    std::map<RayKey, PacketRecord> last_shadows;
    for (const PacketRecord& p : records) {
        if (kind_of(p) != RAYA_KIND_SHADOW) continue;
        PacketRecord& known = last_shadows.emplace(key_of(p), p).first->second;
        if (raya_state_light(p.head.state) >= raya_state_light(known.head.state)) known = p;
    }
    std::map<std::pair<RayKey, std::uint32_t>, int> returns;
    std::size_t misrouted = 0, repeated = 0, early = 0, misplaced = 0;
    for (const PacketRecord& p : records) {
        if (kind_of(p) != RAYA_KIND_RETURN) continue;
        const std::uint32_t light = raya_state_light(p.head.state);
        misrouted += p.destination != RAYA_ROOT || p.source == RAYA_ROOT;
        repeated += ++returns[{key_of(p), one_return_per_ray ? 0 : light}] > 1;
        const auto shadow = last_shadows.find(key_of(p));
        if (!one_return_per_ray || shadow == last_shadows.end()) continue;
        const std::uint32_t last_light = raya_state_light(shadow->second.head.state);
        early += light < last_light;
        misplaced += light == last_light && p.source != shadow->second.destination;
    }
    CHECK(misrouted == 0);
    CHECK(repeated == 0);
    CHECK(early == 0);
    CHECK(misplaced == 0);
}

// Returns the number of rays that nodes make for the pixels in their windows and discard. Each node also makes the rays
// of its rows of the image; the rows of all nodes contain every pixel once, and all nodes together keep one ray per
// pixel.
std::uint64_t pixels_of_windows(const Scene& scene, const TorusSettings& s) {
    const PackedJob job = pack_job(scene, job_settings(s, length_scale(scene, s.format)));
    std::uint64_t pixels = 0;
    for (const PixelWindow& w : pixel_windows(job.header(), partition(job, s.format, s.voxels).grid, s.torus, s.format))
        for (std::uint32_t row = w.rows[0]; row < w.rows[1]; ++row)
            for (std::uint32_t column = w.columns[0]; column < w.columns[1]; ++column)
                pixels += (row * s.width + column) % s.pixels.stride == s.pixels.first;
    return pixels;
}

}  // namespace

TEST_CASE("random machines: packets, hops and words agree with the events and the routing rules", "[torus]") {
    const std::uint64_t seed = 5150;
    SplitMix random(seed);
    Session session(choose_device(""));
    std::uint64_t wide = 0, discarded = 0;
    for (unsigned i = 0; i < quick_cases(20, 80); ++i) {
        const std::string format = i % 6 == 0 ? "spa22" : "fp32";
        const Scene scene =
            i % 3 == 0 ? far_mirror_scene(seed + i, format) : random_view_scene(kSceneSeeds[i % kSceneSeeds.size()]);
        TorusCase c{
            .width = 1 + random_below(random, 24), .height = 1 + random_below(random, 20), .lanes = 4, .group = 1};
        c.format = format;
        for (std::uint32_t& side : c.nodes) side = 1 + random_below(random, 4);
        c.links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
        c.inject = random.next() % 2 ? Injection::kAll : Injection::kRoot;
        c.packets = random_charge(random);
        if (i % 4 == 0)
            for (std::size_t axis = 0; axis < 3; ++axis) c.voxels[axis] = 1 + random_below(random, 7);
        if (i % 5 == 4) c.pixels = {3, random_below(random, 3)};
        CAPTURE(seed, i, case_text(c));
        const TorusSettings s = settings_of(c);
        std::vector<PacketRecord> records;
        const TorusResult r = render_torus(session, scene, c, [&](const PacketRecord& p) { records.push_back(p); });
        check_kinds(r, traced_pixels(s), lights_of(scene), c.packets.one_return_per_ray);
        check_traffic(r, records, s);
        check_returns(records, c.packets.one_return_per_ray);
        wide += check_routes(records);
        const bool root_injects = c.inject == Injection::kRoot || raya_nodes(s.torus) == 1;
        CHECK(r.events[RAYA_DISCARDED] == (root_injects ? 0 : pixels_of_windows(scene, s)));
        discarded += r.events[RAYA_DISCARDED];
    }
    CHECK(wide > 20);
    CHECK(discarded > 1000);
}

}  // namespace raya
