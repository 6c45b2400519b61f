// The main property of both machines: the image, and all counts that cannot depend on the machine, are those of the
// simplest setting, bit for bit. A case is a random scene with random settings; its seed is printed if it fails.
// RAYA_PROPERTY_CASES sets the number of cases. Ranks have their own tests (tests/ranks).
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>
#include <numeric>
#include <tuple>

#include "host/error.hpp"
#include "tests/base/test_checkpointing.hpp"
#include "tests/property/hard_scenes.hpp"
#include "tests/property/whole_image.hpp"
#include "tests/ring/small_mapping.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

/// Seeds of cases that once failed; they run first.
const std::vector<std::uint64_t> kFailedRingSeeds = {}, kFailedTorusSeeds = {};

constexpr std::uint64_t kFirstSeed = 20'260'000;

std::vector<std::uint64_t> seeds(const std::vector<std::uint64_t>& failed, unsigned few, unsigned all) {
    const char* const given = std::getenv("RAYA_PROPERTY_CASES");
    const unsigned cases = given ? static_cast<unsigned>(std::atoi(given)) : quick_cases(few, all);
    std::vector<std::uint64_t> all_seeds = failed;
    for (unsigned i = 0; i < cases; ++i) all_seeds.push_back(kFirstSeed + i);
    return all_seeds;
}

/// What the cases contained, so that a generator that misses something fails.
using Seen = std::map<std::string, int>;

/// Builds of the kernels. There are few, because each takes seconds to compile.
struct Build {
    const char* format;
    AccelKind accel;
    std::uint32_t lanes, group;
    bool packets = false;  // rays descend through the BVH together
    bool plain = false;    // replacement code: words in global memory, emulated arithmetic, no filters
    std::vector<std::string> options{};
    bool divides = false;  // the objects may be in parts
};
const Build kRingBuilds[] = {{"fp32", AccelKind::kNone, 4, 1},
                             {"spa22", AccelKind::kNone, 4, 1, false, false, {}, true},
                             {"fp32", AccelKind::kNone, 8, 3, false, false, {}, true},
                             {"spa22", AccelKind::kNone, 4, 3, false, true},
                             {"fp32", AccelKind::kGrid, 4, 3},
                             {"fp32", AccelKind::kBvh, 4, 1},
                             {"spa22", AccelKind::kBvh, 4, 1},
                             {"fp32", AccelKind::kBvh, 8, 3, true},  // packets need eight lanes (shading/tree.clh)
                             // Only if thorough():
                             {"spa22", AccelKind::kNone, 16, 3, false, false, {}, true},
                             {"fp32", AccelKind::kNone, 1, 1, false, false, {"-cl-opt-disable"}},
                             {"spa22", AccelKind::kGrid, 4, 3}};
constexpr std::uint32_t kQuickRingBuilds = 8;
const Build kTorusBuilds[] = {
    {"fp32", AccelKind::kNone, 4, 1}, {"fp32", AccelKind::kNone, 1, 3}, {"spa22", AccelKind::kNone, 4, 1}};

KernelChoice kernels_of(const Build& build) {
    KernelChoice kernels{.lanes = build.lanes, .group_size = build.group};
    kernels.filter = kernels.local_words = kernels.exact_arithmetic = !build.plain;
    kernels.sources.more_options = build.options;
    return kernels;
}

Scene random_scene(SplitMix& random, const Build& build) {
    const std::uint64_t seed = random.next() % 1000;
    const bool fp32 = build.format == std::string("fp32");
    switch (random_below(random, 6)) {
        case 0:
            return crowded_scene(seed);
        case 1:
            return scene_with_copies(seed);
        case 2:
            return fp32 ? scene_of_a_corner(seed) : crowded_scene(seed);
        case 3:
            return far_mirror_scene(seed, build.format);
        default:
            return random_view_scene(seed);
    }
}

/// Calls render(checkpointing), which stops up to twice and resumes from the checkpoint.
template <class Render>
auto render_in_parts(SplitMix& random, Seen& seen, const Render& render) {
    std::string saved;
    for (std::uint32_t stops = random_below(random, 3);; --stops) {
        TestCheckpointing checkpoints(stops > 0 ? 1 + static_cast<int>(random_below(random, 8)) : 1 << 30, saved);
        seen["resumed"] += !saved.empty();
        try {
            return render(stops > 0 || !saved.empty() ? checkpoints.checkpointing() : nullptr);
        } catch (const Stopped&) {
            saved = checkpoints.saved();
        }
    }
}

/// Names of the results that are wrong; empty if there are none.
struct Findings {
    std::string wrong;
    void expect(bool holds, const std::string& name) { wrong += holds ? "" : name + "; "; }
};

Antialias random_antialias(SplitMix& random) {
    constexpr std::array kMethods = {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample};
    constexpr std::array kExchanges = {ExchangeMethod::kRing, ExchangeMethod::kBus, ExchangeMethod::kBroadcast};
    return {.method = kMethods[random_below(random, 3)],
            .threshold = std::array{0.0, 0.03125, 0.125, 0.5}[random_below(random, 4)],
            .points = random.next() % 2 ? RAYA_POINTS_AXES : RAYA_POINTS_DIAGONALS,
            .exchange = kExchanges[random_below(random, 3)]};
}

RingSettings random_ring(SplitMix& random, const Build& build) {
    RingSettings s;
    s.machine = machine_named("grande");
    s.bounces = kTestBounces;
    s.format = parse_format(build.format);
    s.kernels = kernels_of(build);
    s.antialias = random_antialias(random);
    const bool smoothed = s.antialias.method != AntialiasMethod::kNone;
    do s.mapping = any_mapping(random, 20);
    while (smoothed && s.mapping.kind == RAYA_RANDOM);  // raya refuses it
    if (build.packets) s.mapping = mapping_of_kind(random, s.mapping, RAYA_TILES);
    s.packets = build.packets;
    s.accel.kind = build.accel;
    if (build.accel == AccelKind::kGrid && random.next() % 2)
        s.accel.divisions = {1 + random_below(random, 9), 1 + random_below(random, 9), 1 + random_below(random, 9)};
    if (!smoothed && !build.packets && random.next() % 3 == 0)
        s.dynamic = DynamicPlan{1 + random_below(random, 9), random_below(random, 500), random.uniform(0, 1)};
    if (build.divides && !s.dynamic && random.next() % 2) {
        const std::uint32_t divisor = 1 + random_below(random, s.mapping.pes);  // of a multiple, which s.split divides
        s.split = std::gcd(divisor * 12, s.mapping.pes);
    }
    s.record_costs = !build.packets && random.next() % 4 > 0;
    if (random.next() % 2) s.work_per_launch = 1 + random_below(random, 2000);
    if (!smoothed && random.next() % 2) s.device_pixels = 1 + random_below(random, s.mapping.width * s.mapping.height);
    return s;
}

/// Returns the settings of the simplest machine: one PE with enough memory, which traces one ray at a time.
RingSettings simplest(const RingSettings& s) {
    RingSettings simple;
    simple.machine = machine_named("grande");
    simple.mapping = {s.mapping.width, s.mapping.height, 1, 0, RAYA_FOLD_CYCLIC};
    simple.bounces = s.bounces;
    simple.format = s.format;
    simple.antialias = s.antialias;
    simple.antialias.exchange = ExchangeMethod::kRing;
    simple.kernels.lanes = simple.kernels.group_size = 1;
    simple.record_costs = true;
    return simple;
}

/// Limits the PEs' memory so that a random number of pixels and of ray trees fits.
void limit_memory(SplitMix& random, RingSettings& s, const PeMemory& known) {
    PeDemand demand = pe_demand(s, "random", known.job_words);
    demand.parts = std::max(1u, s.split);
    if (s.split > 1) demand.part_words = known.job_words;  // more than the words of a part
    const PeMemory whole = plan_pe_memory(s.machine, demand);
    s.machine.pe_memory_bytes = whole.bytes() - 12ull * random_below(random, largest_share(s.mapping)) -
                                4 * whole.tree_words * random_below(random, whole.trees);
}

void compare_images(Findings& f, Session& session, const Scene& scene, const RingSettings& s, const RingResult& result,
                    const RingResult& simple) {
    f.expect(pixel_hash(result.image) == pixel_hash(simple.image), "image");
    f.expect(pixel_hash(result.mask) == pixel_hash(simple.mask), "mask");
    f.expect(result.recomputed == simple.recomputed, "recomputed");
    if (s.antialias.method == AntialiasMethod::kNone) return;
    RingSettings without = simplest(s);
    without.antialias = {};
    const Image plain = RingRenderer(session, scene, without).render().image;
    using namespace whole_image;
    if (s.antialias.method == AntialiasMethod::kFilter)
        f.expect(count_differences(result.image, filtered(plain, s.format)) == 0, "filter of the whole image");
    else {
        f.expect(count_differences(result.mask, contrast_mask(plain, s.antialias.threshold, s.format)) == 0,
                 "contrasts of the whole image");
        for (std::size_t i = 0; i < plain.rgb.size(); ++i)
            f.expect(result.mask.rgb[i] == 1 || result.image.rgb[i] == plain.rgb[i], "pixel without a mark");
        f.expect(result.phases[1].events[RAYA_PRIMARY] == 4 * result.recomputed, "points of marked pixels");
    }
}

std::uint64_t total(const std::vector<std::uint64_t>& cycles) {
    return std::accumulate(cycles.begin(), cycles.end(), std::uint64_t{0});
}

/// `simple`: result without an accelerator; `counted`: result with the accelerator of `s`, on which the counts of tests
/// and steps depend.
void compare_counts(Findings& f, const RingSettings& s, const RingResult& result, const RingResult& simple,
                    const RingResult& counted) {
    f.expect(result.phases.size() == simple.phases.size(), "phases");
    for (std::size_t i = 0; i < result.phases.size(); ++i) {
        const EventCounts &events = result.phases[i].events, &expected = counted.phases[i].events;
        for (std::size_t e = 0; e < RAYA_EVENTS; ++e) {
            const bool is_ray_event = e < RAYA_SPHERE_TESTS;
            if (e == RAYA_RESUMED && s.split > 1) continue;
            f.expect(events[e] == (s.packets && !is_ray_event ? 0 : expected[e]), "event " + std::to_string(e));
            f.expect(!is_ray_event || expected[e] == simple.phases[i].events[e], "accel's event " + std::to_string(e));
        }
        if (s.packets) continue;  // costs are not counted
        const CostImage& cost = counted.phases[i].cost();
        if (s.split > 1) {
            const std::uint64_t expected_cycles =
                total(cost.cycles) + cycles_of_events()[RAYA_RESUMED] * events[RAYA_RESUMED];
            if (s.record_costs) f.expect(total(result.phases[i].cost().cycles) == expected_cycles, "cost with parts");
            f.expect(total(result.phases[i].load.per_pe) == expected_cycles, "load with parts");
            f.expect(result.phases[i].barrier_cycles() >= result.phases[i].load.max, "cycles of turns");
            continue;
        }
        if (s.record_costs) f.expect(result.phases[i].cost().cycles == cost.cycles, "cost");
        f.expect(
            result.phases[i].load.per_pe ==
                (s.dynamic ? dynamic_schedule(cost, s.mapping, *s.dynamic).load : static_load(cost, s.mapping)).per_pe,
            "load");
    }
    const Communication& c = result.communication;
    const PeMemory& memory = result.pe_memory;
    const std::uint32_t share = largest_share(s.mapping), pixels = s.mapping.width * s.mapping.height;
    f.expect(c.gather_words == 3ull * pixels, "gather words");
    f.expect(c.gathers == (share + memory.block_pixels - 1) / memory.block_pixels, "gathers");
    if (s.machine.pe_memory_bytes) f.expect(memory.bytes() <= *s.machine.pe_memory_bytes, "memory");
    const std::uint64_t turn_rotations = result.turns() * (result.parts - 1);
    f.expect(c.rotation_words >= turn_rotations * s.mapping.pes * memory.part_words, "words of parts");
    if (s.antialias.method == AntialiasMethod::kNone) return f.expect(c.rotations == turn_rotations, "rotations");
    const std::uint64_t bands = (share + memory.band_pixels - 1) / memory.band_pixels;
    f.expect(c.rotations + c.transfers + c.pe_broadcasts ==
                 turn_rotations + bands * sum_of(smoothing_moves(s.antialias, s.mapping)),
             "moves");
}

using Patches = std::vector<SourcePatch>;

/// Ends a render that an injected fault keeps from ending.
void limit_calls(int& calls, const Patches& patches) {
    if (!patches.empty() && ++calls > 5'000) throw std::runtime_error("the render does not end");
}

/// Returns what is wrong with a random render on the ring. `patches` are applied to its kernels.
std::string check_ring(Session& session, std::uint64_t seed, Seen& seen, const Build* build = nullptr,
                       const Patches& patches = {}) {
    SplitMix random(seed);
    if (build == nullptr)
        build = &kRingBuilds[random_below(random, thorough() ? std::size(kRingBuilds) : kQuickRingBuilds)];
    const Scene scene = random_scene(random, *build);
    RingSettings s = random_ring(random, *build);
    RingSettings simple_settings = simplest(s);
    const RingResult simple = RingRenderer(session, scene, simple_settings).render();
    simple_settings.accel = s.accel;
    if (!thorough()) simple_settings.kernels = kernels_of(build->packets ? kRingBuilds[5] : *build);  // compiled anyway
    const RingResult counted =
        build->accel == AccelKind::kNone ? simple : RingRenderer(session, scene, simple_settings).render();
    if (random.next() % 2) limit_memory(random, s, counted.pe_memory);
    s.kernels.sources.patches = patches;
    ProgressCallback progress;
    int calls = 0;
    if (random.next() % 2 || !patches.empty()) progress = [&](double) { limit_calls(calls, patches); };
    INFO(fmt::format("{}x{}, {} on {} PEs of {} bytes, {} parts, {} by {}, work {}, device pixels {}", s.mapping.width,
                     s.mapping.height, mapping_text(s.mapping), s.mapping.pes, s.machine.pe_memory_bytes.value_or(0),
                     s.split, antialias_name(s.antialias.method), exchange_name(s.antialias.exchange),
                     s.work_per_launch, s.device_pixels));
    const RingResult result = render_in_parts(random, seen, [&](const Checkpointing* checkpointing) {
        if (s.packets) checkpointing = nullptr;  // the program combines checkpoints only with counts
        RingRenderer renderer(session, scene, s);
        if (random.next() % 4 == 0) renderer.render();  // a renderer may render several images
        return renderer.render(progress, checkpointing);
    });
    Findings f;
    compare_images(f, session, scene, s, result, simple);
    compare_counts(f, s, result, simple, counted);
    for (const raya_u32 e : {RAYA_REFLECTED, RAYA_REFRACTED, RAYA_SHADOW_HITS, RAYA_HIGHLIGHTS, RAYA_PLANE_TESTS})
        seen["event " + std::to_string(e)] += result.events[e] > 100;
    seen["mapping " + std::to_string(s.mapping.kind)] += s.mapping.pes > 1;
    seen["build " + std::to_string(build - kRingBuilds)]++;
    seen["rotations"] += result.communication.rotations > 0;
    seen["transfers"] += result.communication.transfers > 0;
    seen["broadcasts"] += result.communication.pe_broadcasts > 0;
    seen["bands"] += result.pe_memory.band_pixels > 0 && result.pe_memory.band_pixels < result.pe_memory.block_pixels;
    seen["blocks"] += result.communication.gathers > 1;
    seen["parts"] += result.turns() > 2 && result.parts > 2;
    seen["launches"] += s.work_per_launch > 0 && result.launches(kTracePass) > 2;
    seen["schedules"] += s.dynamic.has_value();
    return f.wrong;
}

/// All results of a render on the torus that do not depend on the launches.
auto figures(const TorusResult& r) {
    return std::tuple(pixel_hash(r.image), r.events, r.load.per_pe, r.made, r.ended, r.returns, r.hops, r.link_words,
                      r.link_packets, r.queue_max, r.supersteps.size());
}

/// The traffic, which does not depend on lanes, group size and queues either.
auto traffic(const TorusResult& r) {
    return std::tuple(image_and_counts(r), r.made, r.ended, r.events[RAYA_DISCARDED], r.link_words, r.link_packets);
}

TorusCase random_torus_case(SplitMix& random, const Build& build, std::uint32_t lights) {
    TorusCase c{.width = 1 + random_below(random, 10), .height = 1 + random_below(random, 8)};
    c.lanes = build.lanes;
    c.group = build.group;
    c.bounces = kTestBounces;
    c.format = build.format;
    c.nodes = random_sides(random, 4);
    const std::uint32_t voxel_choice = random_below(random, 4);
    for (std::size_t axis = 0; axis < 3; ++axis)
        c.voxels[axis] =
            voxel_choice == 0   ? c.nodes[axis]
            : voxel_choice == 1 ? 1 + random_below(random, c.nodes[axis])        // at most as many voxels as nodes
            : voxel_choice == 2 ? c.nodes[axis] * (1 + random_below(random, 3))  // a multiple of the number of nodes
                                : 1 + random_below(random, 9);
    c.links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
    c.inject = random.next() % 2 ? Injection::kAll : Injection::kRoot;
    c.packets = random_charge(random);
    const std::uint32_t min_queue = raya_min_queue(lights, c.bounces);
    c.queue =
        std::array{min_queue + random_below(random, 20), 3 * min_queue, 20 * min_queue, 0u}[random_below(random, 4)];
    return c;
}

/// Renders with longer queues after each deadlock; s.queue is then the length that sufficed.
TorusResult render_without_deadlock(Session& session, const Scene& scene, TorusSettings& s) {
    for (;;) try {
            return TorusRenderer(session, scene, s).render();
        } catch (const TorusDeadlock& deadlock) {
            s.queue = 2 * deadlock.queue;
        }
}

/// Returns the image and the counts of all pixel subsets together.
std::string image_and_counts_of_subsets(Session& session, const Scene& scene, TorusSettings s, std::uint32_t stride) {
    Image whole{static_cast<int>(s.width), static_cast<int>(s.height), std::vector<float>(3ull * s.width * s.height)};
    EventCounts events{};
    for (std::uint32_t first = 0; first < stride; ++first) {
        s.pixels = {stride, first};
        const TorusResult part = render_without_deadlock(session, scene, s);
        for (std::size_t e = 0; e < events.size(); ++e) events[e] += part.events[e];
        for (std::size_t i = 0; i < whole.rgb.size(); ++i) whole.rgb[i] += part.image.rgb[i];  // 0 outside the subset
    }
    return image_and_counts(whole, events);
}

/// Returns what is wrong with random renders on the torus. `patches` are applied to their kernels.
std::string check_torus(Session& session, std::uint64_t seed, Seen& seen, const Build* build = nullptr,
                        const Patches& patches = {}) {
    SplitMix random(seed);
    if (build == nullptr) build = &kTorusBuilds[random_below(random, std::size(kTorusBuilds))];
    const Scene scene = random_scene(random, *build);
    const TorusCase c = random_torus_case(random, *build, lights_of(scene));
    INFO(case_text(c));
    RingSettings ring;
    ring.mapping.width = c.width;
    ring.mapping.height = c.height;
    ring.bounces = c.bounces;
    ring.format = parse_format(c.format);
    const RingResult simple = RingRenderer(session, scene, simplest(ring)).render();
    const std::string expected = image_and_counts(simple.image, simple.events);
    TorusSettings s = settings_of(c);
    s.kernels.sources.patches = patches;
    const TorusResult result = render_without_deadlock(session, scene, s);
    Findings f;
    f.expect(image_and_counts(result) == expected, "image or counts");
    TorusSettings parts = s;
    parts.work_per_launch = std::array{0u, 1u, 7u, 100u}[random_below(random, 4)];
    const TorusResult in_parts = render_in_parts(random, seen, [&](const Checkpointing* checkpointing) {
        return TorusRenderer(session, scene, parts).render({}, {}, checkpointing);
    });
    f.expect(figures(in_parts) == figures(result), "resumed render");
    const std::uint32_t stride = 1 + random_below(random, 3);
    if (stride > 1) f.expect(image_and_counts_of_subsets(session, scene, s, stride) == expected, "pixel subsets");
    const Build& other = kTorusBuilds[random_below(random, std::size(kTorusBuilds))];
    if (other.format == c.format && other.lanes != c.lanes) {
        TorusSettings other_lanes = s;
        other_lanes.kernels = kernels_of(other);
        f.expect(traffic(render_without_deadlock(session, scene, other_lanes)) == traffic(result), "traffic");
        seen["other lanes"]++;
    }
    seen["build " + std::to_string(build - kTorusBuilds)]++;
    seen["hops"] += result.hops > 100;
    seen["subsets"] += stride > 1;
    seen["launches"] += parts.work_per_launch > 0;
    for (const raya_u32 e : {RAYA_REFLECTED, RAYA_REFRACTED, RAYA_SHADOW_HITS, RAYA_DISCARDED})
        seen["event " + std::to_string(e)] += result.events[e] > 10;
    return f.wrong;
}

void check_seen(const Seen& seen) {
    for (const auto& [what, cases] : seen) {
        CAPTURE(what);
        CHECK(cases > 0);
    }
}

}  // namespace

TEST_CASE("ring: image and counts are those of the simplest machine", "[property][ring]") {
    Session session(choose_device(""));
    Seen seen;
    for (const std::uint64_t seed : seeds(kFailedRingSeeds, 80, 3000)) {
        CAPTURE(seed);
        CHECK(check_ring(session, seed, seen) == "");
    }
    check_seen(seen);
}

TEST_CASE("torus: image and counts are those of the simplest machine", "[property][torus]") {
    Session session(choose_device(""));
    Seen seen;
    for (const std::uint64_t seed : seeds(kFailedTorusSeeds, 35, 1000)) {
        CAPTURE(seed);
        CHECK(check_torus(session, seed, seen) == "");
    }
    check_seen(seen);
}

TEST_CASE("an injected fault gives another image or count", "[property][faults]") {
    struct Fault {
        SourcePatch patch;
        const Build& build;
        decltype(&check_ring) check = check_ring;
    };
    const Build &ring = kRingBuilds[0], &grid = kRingBuilds[4], &bvh = kRingBuilds[5], &reduced_bvh = kRingBuilds[6],
                &torus = kTorusBuilds[0];
    const std::vector<Fault> faults = {
        {{"shared/share_pixels.h", "k / s.slots * s.row_step", "k / s.slots"}, ring},
        {{"ring/saved_trees.clh", "    transfer_vec(k, &sum);\n", ""}, ring},
        {kBorderFault, ring},
        {kResumedLaunchFault, torus, check_torus},
        {kGridFault, grid},
        {{"ring/saved_trees.clh", "    transfer_index(k, &t->level);\n", ""}, ring},
        {{"ring/saved_trees.clh", "if (mask_any((t->pending_levels.all & (index)(1u << level)) != (index)(0)))",
          "if (level == 0)"},
         ring},
        {{"ring/saved_trees.clh", "transfer_index(k, &t->events[e].all)", ""}, ring},
        {{"ring/saved_trees.clh", "    transfer_vec(k, &p->colour);\n", ""}, ring},
        {kLostPartFault, kRingBuilds[1]},
        {kPartTwiceFault, kRingBuilds[1]},
        {kRotationFault, kRingBuilds[1]},
        {{"ring/flight.clh", "    transfer_real(k, &f->place.surface.transmit);\n", ""}, kRingBuilds[1]},
        {{"ring/turn.cl", "(number < f->found.object)", "(number > f->found.object)"}, kRingBuilds[1]},
        {{"ring/trace.cl", "const int resumes = progress[group].left > 0;", "const int resumes = 0;"}, ring},
        {{"ring/pixel_store.clh", "progress[group].left = mine->left;", "progress[group].left = 0;"}, ring},
        {{"bvh/boxes.clh", "inverse < 0.0f, (index)((RAYA_BVH_HIGH", "inverse < 2.0f, (index)((RAYA_BVH_HIGH"}, bvh},
        {{"bvh/meet_leaves.clh", "p->distance.all = h.distance;", "p->distance.all = h.distance * 0.99f;"},
         reduced_bvh},
        {{"bvh/leaves.clh", "return popcount(crossed) & 1u;", "return crossed & 1u;"}, bvh},
        {{"bvh/boxes.clh", "const mask enters = near <= far;", "const mask enters = near + 0.01f <= far;"}, bvh},
        {{"bvh/boxes.clh", "popcount(entered) - 1", "popcount(entered) - 2 + (popcount(entered) == 1)"}, bvh},
        {{"bvh/descent.clh", "!(p->entries[lane][at] > p->distance.lane[lane])",
          "!(p->entries[lane][at] * 1.01f > p->distance.lane[lane])"},
         bvh},
        {{"bvh/descent.clh", "!shadow || p->object.lane[lane]", "p->object.lane[lane]"}, bvh},
        {{"bvh/leaves.clh", "number < h->object;", "number > h->object;"}, bvh},
        {{"bvh/leaves.clh", "crosses_edge(seen[2], seen[3]) ^ crosses_edge(seen[3], seen[0])",
          "crosses_edge(seen[2], seen[0])"},
         bvh},
        {{"geometry/cone.clh", "choose(in & mask_not(out & (x.t_out <= x.t_in))", "choose(in & mask_not(out)"}, bvh},
        {{"bvh/meet_leaves.clh", "raya_link_number(p->link[lane]);", "raya_link_number(p->link[lane]) & ~1u;"},
         reduced_bvh},
        {{"bvh/ray_pool.clh", "m & mask_not(done);", "m & mask_not(done) & (r->direction.x > 0.0f);"}, bvh}};
    Session session(choose_device(""));
    for (const Fault& fault : quick_of(5, faults)) {
        CAPTURE(fault.patch.file, fault.patch.replace);
        Seen seen;
        bool is_detected = false;
        for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 20 && !is_detected; ++seed) try {
                is_detected = fault.check(session, seed, seen, &fault.build, {fault.patch}) != "";
            } catch (const std::exception&) {
                is_detected = true;
            }
        CHECK(is_detected);
    }
}

}  // namespace raya
