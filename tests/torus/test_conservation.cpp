// Conservation of packets: numbers of packets made and ended, hops and words on links, and the voxels that rays visit.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <numeric>
#include <sstream>
#include <tuple>

#include "host/torus/torus_trace.hpp"
#include "tests/base/gunzip.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/record_packets.hpp"

namespace raya {
namespace {

bool is_wide(const PacketRecord& p) { return state_of(p) & RAYA_STATE_WIDE; }

std::uint64_t sum(const std::vector<std::uint64_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

// Identifies a ray, which may be a shadow ray: pixel, path, level, light. The records with the same key are the stages
// of the ray's traversal of the voxels.
using LightKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
LightKey light_key(const PacketRecord& p) {
    return {p.head.pixel, p.head.path, raya_state_level(state_of(p)), raya_state_light(state_of(p))};
}

std::map<LightKey, std::vector<PacketRecord>> stages_of(const std::vector<PacketRecord>& records) {
    std::map<LightKey, std::vector<PacketRecord>> stages;
    for (const PacketRecord& p : records)
        if (kind_of(p) != RAYA_KIND_RETURN) stages[light_key(p)].push_back(p);
    return stages;
}

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

// Checks that each packet crosses as many links as the torus distance between its source and destination, and that each
// link carries the number of words that follows from the routing rules.
void check_traffic(const RecordedRender& r, const TorusSettings& s) {
    std::uint64_t hops = 0;
    std::vector<std::uint64_t> words(r.result.link_words.size());
    std::size_t to_itself = 0, wrong_words = 0;
    for (const PacketRecord& p : r.records) {
        const std::uint64_t distance = raya_node_distance(s.torus, p.source, p.destination);
        to_itself += distance == 0;
        hops += distance;
        add_route(words, s.torus, p);
        wrong_words += p.words != (kind_of(p) == RAYA_KIND_RETURN ? s.packets.return_words() : s.packets.ray_words);
    }
    CHECK(to_itself == 0);
    CHECK(wrong_words == 0);
    CHECK(r.result.hops == hops);
    CHECK(sum(r.result.link_packets) == hops);
    CHECK(r.result.link_words == words);
    for (std::uint32_t i = 0; i < r.result.link_words.size(); ++i)
        if (s.torus.sides[i % RAYA_LINKS / 2] == 1) CHECK(r.result.link_words[i] == 0);
    CHECK(std::is_sorted(r.records.begin(), r.records.end(), [](const PacketRecord& a, const PacketRecord& b) {
        return std::tie(a.superstep, a.source) < std::tie(b.superstep, b.source);
    }));
    CHECK((r.records.empty() || r.records.back().superstep < r.result.supersteps.size()));
    CHECK(r.result.supersteps.back().live <= r.result.made[RAYA_KIND_RETURN]);  // returns not yet read by the host
}

std::uint32_t voxel_number(const raya_grid& grid, const PacketRecord& p) {
    const raya_place at = raya_unpack_place(p.head.voxel);
    return raya_voxel(grid, at.at[0], at.at[1], at.at[2]);
}

// Returns true if each step of a ray leads to a neighbouring voxel and the ray never reverses its direction along an
// axis.
bool is_walk(const std::vector<PacketRecord>& stages) {
    bool is_valid = true;
    for (std::size_t i = 1; i < stages.size(); ++i) {
        const raya_place a = raya_unpack_place(stages[i - 1].head.voxel);
        const raya_place b = raya_unpack_place(stages[i].head.voxel);
        std::uint32_t steps = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const int step = static_cast<int>(b.at[axis]) - static_cast<int>(a.at[axis]);
            steps += static_cast<std::uint32_t>(std::abs(step));
            const raya_place first = raya_unpack_place(stages[0].head.voxel);
            const int steps_before = static_cast<int>(a.at[axis]) - static_cast<int>(first.at[axis]);
            is_valid = is_valid && step * steps_before >= 0;
        }
        is_valid = is_valid && steps == 1;
    }
    return is_valid;
}

// Returns true if a wide ray visits all voxels in cyclic order. The node that made the ray tests its own voxel without
// a packet, so the first record is for the next voxel. A shadow ray may end earlier, in the voxel in which it is
// blocked. At most one more stage follows, to the voxel in which the ray's hit is shaded.
bool is_tour(const std::vector<PacketRecord>& stages, const raya_torus& torus, const raya_grid& grid) {
    const std::uint32_t voxels = raya_voxels(grid);
    const std::size_t visits = stages.size() - (state_of(stages.back()) & RAYA_STATE_FOUND ? 1 : 0);
    std::uint32_t number = raya_voxel_of_node(torus, grid, stages[0].source, 0);
    bool is_valid = visits < voxels && (visits == voxels - 1 || kind_of(stages[0]) == RAYA_KIND_SHADOW);
    for (std::size_t i = 0; i < stages.size(); ++i) {
        number = (number + 1) % voxels;
        is_valid = is_valid && (i >= visits || voxel_number(grid, stages[i]) == number);
        is_valid = is_valid && (i < visits) == !(state_of(stages[i]) & RAYA_STATE_FOUND);
    }
    return is_valid;
}

struct RayCounts {
    std::size_t narrow = 0, wide = 0;
};

// Checks the voxels that each ray visits. Each node must hold one voxel, so that every step sends a packet, which is
// recorded.
RayCounts check_walks(const RecordedRender& r, const TorusSettings& s) {
    RayCounts counts;
    std::size_t interrupted_routes = 0, early_stages = 0, wrong_walks = 0, wrong_tours = 0;
    raya_grid grid{};
    std::copy_n(s.voxels.begin(), 3, grid.divisions);
    for (const auto& [key, stages] : stages_of(r.records)) {
        for (std::size_t i = 1; i < stages.size(); ++i) {
            interrupted_routes += stages[i].source != stages[i - 1].destination;
            early_stages += stages[i].superstep <= stages[i - 1].superstep;
        }
        (is_wide(stages[0]) ? counts.wide : counts.narrow) += 1;
        wrong_walks += !is_wide(stages[0]) && !is_walk(stages);
        wrong_tours += is_wide(stages[0]) && !is_tour(stages, s.torus, grid);
    }
    CHECK(interrupted_routes == 0);
    CHECK(early_stages == 0);
    CHECK(wrong_walks == 0);
    CHECK(wrong_tours == 0);
    return counts;
}

// Checks that every return goes to the root, and that each ray of a pixel's ray tree, shadow rays included, has at most
// one return.
void check_returns(const RecordedRender& r) {
    std::map<LightKey, int> return_counts;
    std::size_t misrouted = 0;
    for (const PacketRecord& p : r.records) {
        if (kind_of(p) != RAYA_KIND_RETURN) continue;
        misrouted += p.destination != RAYA_ROOT || p.source == RAYA_ROOT;
        ++return_counts[light_key(p)];
    }
    CHECK(misrouted == 0);
    CHECK(std::all_of(return_counts.begin(), return_counts.end(), [](const auto& a) { return a.second == 1; }));
}

// A row of a packet trace.
struct Row {
    std::uint64_t superstep = 0, source = 0, destination = 0, bytes = 0, ray = 0;
    std::string kind, parent;
};

std::vector<Row> rows_of(const std::string& csv) {
    std::istringstream lines(csv);
    std::string line;
    std::getline(lines, line);
    std::vector<Row> rows;
    while (std::getline(lines, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        Row row;
        fields >> row.superstep >> row.source >> row.destination >> row.kind >> row.bytes >> row.ray >> row.parent;
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

TEST_CASE("random machines: packets, hops and words agree with the events and the routing rules", "[torus]") {
    const std::uint64_t seed = 5150;
    SplitMix random(seed);
    Session session(choose_device(""));
    RayCounts total;
    const unsigned cases = quick_cases(20, 60);
    for (unsigned i = 0; i < cases; ++i) {
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
        const bool one_voxel_per_node = i % 4 > 0 || i % 8 == 0;
        if (!one_voxel_per_node)
            for (std::size_t axis = 0; axis < 3; ++axis) c.voxels[axis] = 1 + random_below(random, 7);
        c.pixels.stride = i % 5 == 4 ? 1 + random_below(random, 5) : 1;
        CAPTURE(seed, i, case_text(c));
        const TorusSettings s = settings_of(c);
        const RecordedRender r = render_and_record(session, scene, c);
        check_kinds(r.result, (c.width * c.height - 1) / c.pixels.stride + 1, lights_of(scene),
                    c.packets.one_return_per_ray);
        check_traffic(r, s);
        check_returns(r);
        if (!one_voxel_per_node) continue;
        const RayCounts case_counts = check_walks(r, s);
        total.narrow += case_counts.narrow;
        total.wide += case_counts.wide;
    }
    CHECK(total.narrow > (thorough() ? 5'000 : 1'000));
    CHECK(total.wide > (thorough() ? 100 : 20));
}

TEST_CASE("recording the packets changes no result", "[torus]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[1]);
    const TorusCase c{.nodes = {3, 2, 2}, .lanes = 4, .group = 1};
    const TorusResult recorded = render_and_record(session, scene, c).result,
                      unrecorded = render_torus(session, scene, c);
    CHECK(image_and_counts(recorded) == image_and_counts(unrecorded));
    CHECK(recorded.link_words == unrecorded.link_words);
    CHECK(recorded.supersteps.size() == unrecorded.supersteps.size());
}

TEST_CASE("the supersteps' maxima add up to at least the maximum over nodes or links and at most the sum over them",
          "[torus]") {
    const TorusResult r =
        render_torus(random_view_scene(kSceneSeeds[2]), TorusCase{.nodes = {3, 2, 3}, .lanes = 4, .group = 1});
    std::uint64_t cycles = 0, words = 0;
    for (const Superstep& step : r.supersteps) {
        cycles += step.max_node_cycles;
        words += step.max_link_words;
    }
    const auto& loads = r.load.per_pe;
    CHECK(cycles >= *std::max_element(loads.begin(), loads.end()));
    CHECK(cycles <= sum(loads));
    CHECK(words >= *std::max_element(r.link_words.begin(), r.link_words.end()));
    CHECK(words <= sum(r.link_words));
    CHECK(r.supersteps.back().max_link_words == 0);
}

TEST_CASE("packet trace of a render: sizes, routes and parents of the rays are valid", "[torus]") {
    const TorusCase c{
        .nodes = {2, 3, 2}, .inject = GENERATE(Injection::kAll, Injection::kRoot), .lanes = 4, .group = 1};
    PacketTrace trace;
    const TorusResult r =
        render_torus(random_view_scene(kSceneSeeds[0]), c, [&](const PacketRecord& record) { trace.add(record); });
    const std::vector<Row> rows = rows_of(gunzip(trace.finish()));
    REQUIRE(rows.size() == trace.rows());
    std::map<std::uint64_t, Row> last_rows;  // by ray: its last row
    std::size_t wrong_bytes = 0, changed_rays = 0, interrupted_routes = 0, repeated_returns = 0, wrong_primaries = 0;
    for (const Row& row : rows) {
        wrong_bytes += row.bytes != (row.kind == "return" ? 32 : 64);
        wrong_primaries += (row.kind == "primary") != row.parent.empty();  // only primary rays have no parent
        const auto [before, is_new] = last_rows.emplace(row.ray, row);
        if (is_new) continue;
        repeated_returns += row.kind == "return";
        changed_rays += before->second.kind != row.kind || before->second.parent != row.parent;
        interrupted_routes += before->second.destination != row.source || before->second.superstep >= row.superstep;
        before->second = row;
    }
    CHECK(wrong_bytes == 0);
    CHECK(changed_rays == 0);
    CHECK(interrupted_routes == 0);
    CHECK(repeated_returns == 0);
    CHECK(wrong_primaries == 0);
    std::map<std::string, std::uint64_t> sent;  // by kind: number of rays that left a node at least once
    std::size_t wrong_parents = 0;
    for (const auto& [ray, row] : last_rows) {
        ++sent[row.kind];
        const auto parent = row.parent.empty() ? last_rows.end() : last_rows.find(std::stoull(row.parent));
        if (parent == last_rows.end()) continue;  // the parent never left its node
        const std::string& kind = parent->second.kind;
        wrong_parents += kind == "return" || (kind == "shadow" && row.kind != "return");
    }
    CHECK(wrong_parents == 0);
    CHECK(sent["primary"] <= r.made[RAYA_KIND_PRIMARY]);
    CHECK(sent["reflected"] <= r.made[RAYA_KIND_REFLECTED]);
    CHECK(sent["refracted"] <= r.made[RAYA_KIND_REFRACTED]);
    CHECK(sent["shadow"] <= r.made[RAYA_KIND_SHADOW]);
    CHECK(sent["return"] <= r.made[RAYA_KIND_RETURN]);
    CHECK(sent["shadow"] > 0);
    CHECK(sent["return"] > r.made[RAYA_KIND_RETURN] / 2);
}

}  // namespace raya
