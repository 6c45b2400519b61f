// Fault injection: each mutant of a kernel, with one changed line, must fail the torus's own checks or change its image
// or traffic. These tests have their own ctest entry: test_torus "[faults]".
#include <catch2/catch.hpp>
#include <stdexcept>

#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

struct KernelFault {
    const char* description;
    SourcePatch patch;
};

const KernelFault kKernelFaults[] = {
    {"accept drops a packet",
     {"torus/accept.cl", "packet.lo = without_flag(packet.lo, RAYA_STATE_FRESH);",
      "packet.lo = without_flag(packet.lo, packet.lo.s0 == 7 ? ~0u : RAYA_STATE_FRESH);"}},
    {"accept takes a packet twice",
     {"torus/accept.cl", "left += votes_for(votes, RAYA_LEFT_THERE, goal);",
      "left += votes_for(votes, RAYA_LEFT_THERE, goal); if (first == 0 && queue->used > 3) left = 1;"}},
    {"route swaps source and destination",
     {"shared/torus.h", "raya_next_link(raya_torus t, raya_u32 from, raya_u32 to)",
      "raya_next_link(raya_torus t, raya_u32 to, raya_u32 from)"}},
    {"of two equally long routes, packets take the descending route",
     {"shared/torus.h", "*up = higher <= side - higher;", "*up = higher < side - higher;"}},
    {"a wide ray records its last hit as the nearest",
     {"torus/outcome.clh", "!= RAYA_NO_VOXEL && !nearer) return;",
      "!= RAYA_NO_VOXEL && !nearer && number > 100000) return;"}},
    {"a wide ray skips its last voxel",
     {"torus/outcome.clh", "if (next == p->start)", "if (next_tour_voxel(n->grid, next) == p->start)"}},
    {"wide rays start in a voxel of i = 0 instead of the node's voxel",
     {"torus/node.clh", "const raya_place p = n->place;", "raya_place p = n->place; p.at[0] = 0;"}},
    {"hits behind the voxel's exit count", {"torus/outcome.clh", "(hits & (h.distance <= exit_distance))", "hits"}},
    {"hits count only in the first half of a voxel",
     {"torus/outcome.clh", "(hits & (h.distance <= exit_distance))", "(hits & (h.distance <= exit_distance * 0.5f))"}},
    {"the traversal moves up by two voxels",
     {"grid/traversal.clh", "const index k = at + choose_index(a->up, (index)(1), (index)(0));",
      "const index k = at + choose_index(a->up, (index)(2), (index)(0));"}},
    {"a return is counted twice", {"torus/route.cl", "+= returns_used - returns_before;", "+= returns_used;"}},
    {"a return is lost between mailboxes", {"torus/accept.cl", "return moves;", "return moves - (moves > 1);"}},
    {"a shadow ray passes through near objects",
     {"torus/outcome.clh", "o.stopped = m & shadow & hits;", "o.stopped = m & shadow & hits & (h.distance > 1.0f);"}},
    {"a pixel's ray is made twice", {"torus/primaries.clh", "p.misses = root || !in_window;", "p.misses = 1;"}},
    {"windows start one row too late",
     {"torus/primaries.clh", "p.row = root ? i : in_window ? header->window[0] + i",
      "p.row = root ? i : in_window ? header->window[0] + i + 1"}},
    {"refraction takes the reflected path",
     {"torus/shade_packets.clh", "f->path.all | (index)(0x80000000u) >> levels_of(f);", "f->path.all;"}},
    {"a light's number is one off",
     {"torus/shade_packets.clh", "shadow.light = (index)(l + 1);", "shadow.light = (index)(l);"}},
    {"discarded rays are not counted", {"torus/inject.cl", "number += !own_rays.lane[lane];", "number += 0;"}},
    {"a ray's return leaves before its shadow rays",
     {"torus/shade_packets.clh", "put_shadow_rays(n, f, struck, &lit);\n    if (!f->charged) charge_newest(f, struck);",
      "if (!f->charged) charge_newest(f, struck);\n    put_shadow_rays(n, f, struck, &lit);"}},
    {"a blocked shadow ray makes no return",
     {"torus/shade_packets.clh", "arrived | (stopped & has_flag(f, RAYA_STATE_CHARGED))", "arrived"}},
    {"every return in transit is a message",
     {"torus/accept.cl", "if (state_of(packet) & RAYA_STATE_CHARGED) shared_add", "shared_add"}},
    {"every return from a queue is a message", {"torus/route.cl", "state_of(packet.lo) & RAYA_STATE_CHARGED", "1"}},
    {"no queue slots are reserved",
     {"torus/trace_voxel.cl", "if (*used_slots + needed_slots > f->capacity) continue;",
      "chosen.lane[lane] = RAYA_TRUE; continue;"}},
};

// Image and traffic of a render.
struct Traffic {
    std::string image;
    PacketCounts made{};
    std::uint64_t discarded = 0;
    std::vector<std::uint64_t> words;     // [node][link]: number of words that the render counted
    std::vector<std::uint64_t> expected;  // [node][link]: number of words according to the routing rules
    bool operator==(const Traffic&) const = default;
};

// Throws an exception at the 5001st call, to end the render of a mutant that does not finish.
void limit_calls(int& calls) {
    if (++calls > 5'000) throw std::runtime_error("the render does not end");
}

Traffic traffic_of(Session& session, const Scene& scene, const TorusCase& c) {
    const TorusSettings s = settings_of(c);
    Traffic t;
    int calls = 0;
    t.expected.assign(std::size_t{raya_nodes(s.torus)} * RAYA_LINKS, 0);
    const TorusResult r = TorusRenderer(session, scene, s)
                              .render([&](double) { limit_calls(calls); },
                                      {.packets = [&](const PacketRecord& p) { add_route(t.expected, s.torus, p); }});
    t.image = image_and_counts(r);
    t.made = r.made;
    t.discarded = r.events[RAYA_DISCARDED];
    t.words = r.link_words;
    return t;
}

// Returns the first difference or error that reveals the fault; empty if there is none.
std::string detect_fault(Session& session, const Scene& scene, TorusCase c, const Traffic& expected,
                         const SourcePatch& patch) {
    c.sources.patches = {patch};
    try {
        const Traffic t = traffic_of(session, scene, c);
        if (t.image != expected.image) return "image: " + t.image;
        if (t.words != t.expected) return "the words over links differ from the routing rules";
        return t == expected ? "" : "numbers of packets, discarded rays or words differ";
    } catch (const std::exception& error) {
        return error.what();
    }
}

}  // namespace

TEST_CASE("the text of every injected fault is in its kernel", "[torus]") {
    for (const KernelFault& fault : kKernelFaults) {
        CAPTURE(fault.description);
        CHECK_NOTHROW(check_patches({.patches = {fault.patch}}));
    }
}

TEST_CASE("every injected kernel fault is detected", "[torus][.][faults]") {
    Session session(choose_device(""));
    struct Trial {
        Scene scene;
        TorusCase c;
    };
    TorusCase narrow_rays{.width = 24, .height = 20, .nodes = {4, 3, 2}, .lanes = 1, .group = 1};
    narrow_rays.queue = raya_min_queue(lights_of(random_view_scene(kSceneSeeds[1])), narrow_rays.bounces) + 30;
    TorusCase wide_rays{.width = 24, .height = 20, .nodes = {4, 3, 2}, .lanes = 1, .group = 1};
    wide_rays.format = "spa22";
    wide_rays.packets = {22, true};
    // The eye is outside the box, so several nodes make a ray for the same pixel.
    const TorusCase eye_outside{.width = 24, .height = 20, .nodes = {4, 3, 2}, .lanes = 1, .group = 1};
    const Trial trials[] = {{random_view_scene(kSceneSeeds[1]), narrow_rays},
                            {far_mirror_scene(kSceneSeeds[3], "spa22"), wide_rays},
                            {random_view_scene(kSceneSeeds[6]), eye_outside}};
    std::vector<Traffic> expected;
    for (const Trial& t : trials) expected.push_back(traffic_of(session, t.scene, t.c));
    for (std::size_t i = 0; i < expected.size(); ++i)
        CHECK(expected[i].image == ring_image_and_counts(trials[i].scene, trials[i].c));
    for (const KernelFault& fault : kKernelFaults) {
        CAPTURE(fault.description);
        std::string detection;
        for (std::size_t i = 0; i < expected.size() && detection.empty(); ++i)
            detection = detect_fault(session, trials[i].scene, trials[i].c, expected[i], fault.patch);
        WARN(fault.description << ": detected by: " << detection);
        CHECK(detection != "");
    }
}

}  // namespace raya
