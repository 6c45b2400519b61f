// Injected faults: patches of kernels that simulate faults of a device or compiler. All except kBarrierFault
// change the code under test; kBarrierFault changes a check.
#pragma once
#include <vector>

#include "host/cl/kernel_source.hpp"

namespace raya {

/// Ties round to the number with an odd significand.
inline const SourcePatch kRoundingFault{"number/reduced.clh", "even = ~(bits <<", "even = (bits <<"};
/// The compiler is allowed to fuse a * b + c.
inline const SourcePatch kContractionFault{"number/lanes.clh", "FP_CONTRACT OFF", "FP_CONTRACT ON"};
/// The device computes a / b as a multiplication by the reciprocal of b.
inline const SourcePatch kDivisionFault{"number/divide.clh", "return a / b;", "return a * (1.0f / b);"};
/// Of several objects at the same distance, the last one is hit instead of the first.
inline const SourcePatch kTieFault{"geometry/sphere.clh", "& (t < h.distance)",
                                   "& ((t < h.distance) | ((t == h.distance) & (h.object != RAYA_NO_OBJECT)))"};
/// The grid traversal ends one voxel early.
inline const SourcePatch kGridFault{"grid/traversal.clh", "raya_voxel_plane(g, axis, g.divisions[axis])",
                                    "raya_voxel_plane(g, axis, g.divisions[axis] - 1)"};
/// A 64-bit product is truncated to 32 bits.
inline const SourcePatch kMappingFault{"shared/mapping.h", "(raya_u64)a * b / c", "a * b / c"};
/// A barrier is missing: work-items read local memory before all have written it.
inline const SourcePatch kBarrierFault{
    "checks/machine.cl", "words - 1 - w] + 1;\n        barrier(CLK_LOCAL_MEM_FENCE);", "words - 1 - w] + 1;"};
/// Wrong address of a large object, which is tested before the BVH.
inline const SourcePatch kSeparateFault{"shading/first_tests.clh", "_at + (separate[i] - first)",
                                        "_at - (separate[i] - first)"};
/// The filter treats pixels at the right border as inner pixels.
inline const SourcePatch kBorderFault{"ring/filter.cl", "raya_has_neighbour(m, pixel, RAYA_RIGHT)", "1"};
/// The link exchange of the torus flips a bit of a colour or limit in a packet. It does not drop words, because stale
/// memory could contain a ray that never terminates.
inline const SourcePatch kExchangeFault{"torus/exchange.cl", "target[i] = source[i];",
                                        "target[i] = source[i] ^ (uint8)(0, 0, 0, 0, 0, 0, 1 << 21, 0);"};
/// A resumed launch assumes that the returns of the previous launch have been transferred, and overwrites them.
inline const SourcePatch kResumedLaunchFault{"torus/accept.cl", "already_sent = !resume && (root",
                                             "already_sent = (root"};

/// PEs of a ring with divided objects lose a part, test a part twice, or hold the part of a neighbour because the parts
/// have rotated once too often.
inline const SourcePatch kLostPartFault{"ring/turn.cl", "needed ? slots : 0", "needed && step != 2u ? slots : 0"};
inline const SourcePatch kPartTwiceFault{
    "ring/turn.cl", "    ulong used = 0;\n    meet_slots(scene, part, needed",
    "    ulong used = 0;\n    if (step == 2u) meet_slots(scene, part, needed ? slots "
    ": 0u, stride, state, &used);\n    meet_slots(scene, part, needed"};
inline const SourcePatch kRotationFault{
    "ring/turn.cl", "parts + (size_t)group * part_words_count",
    "parts + (size_t)((group + (step > 2u)) % get_num_groups(0)) * part_words_count"};

/// A fault at a place where a kernel counts an event: the kernel counts another event, nothing, or the event twice.
struct CountFault {
    const char* event;  // name of the counter in raya verify
    SourcePatch patch;
    const char* only;  // value of --only that selects one of the checks that must fail
};

// Values of CountFault::only.
inline const char* const kOnGlass = "image glass fp32: tiles";
inline const char* const kOnCones = "image cones e5m10";
inline const char* const kOnGrid = "image polygons fp32: cyclic:8 on 20, grid";
inline const char* const kOnBvh = "image polygons fp32: cyclic:8 on 20, bvh";
inline const char* const kOnTorus = "image polygons fp32: torus3d 2x2x2, launches";

inline const std::vector<CountFault> kCountFaults = {
    {"refracted", {"shading/tree.clh", "count_event(t, RAYA_REFRACTED", "count_event(t, RAYA_REFLECTED"}, kOnGlass},
    {"primary_hits",
     {"shading/shade.clh", "RAYA_PRIMARY_HITS, met->struck & (t->level == 0u)", "RAYA_PRIMARY_HITS, met->struck"},
     kOnGlass},
    {"shadow_hits", {"shading/shade.clh", "count_event(t, RAYA_SHADOW_HITS, stopped);", ""}, kOnGlass},
    {"highlights", {"shading/shade.clh", "RAYA_HIGHLIGHTS, shines", "RAYA_HIGHLIGHTS, lit"}, kOnGlass},
    {"sphere_tests",
     {"shading/tree.clh", "m, all->kinds);", "m, all->kinds + (RAYA_##KIND##_TESTS == RAYA_SPHERE_TESTS));"},
     kOnGlass},
    {"cone_tests",
     {"shading/tree.clh", "m, all->kinds);", "m, RAYA_##KIND##_TESTS == RAYA_CONE_TESTS ? all->planes : all->kinds);"},
     kOnCones},
    {"walks", {"grid/grid_search.clh", "count_event(t, RAYA_WALKS, w.on);", ""}, kOnGrid},
    {"polygon_tests",
     {"shading/first_tests.clh", "t->events[RAYA_##KIND##_TESTS].all += tests->kinds.all;",
      "t->events[RAYA_CONE_TESTS].all += tests->kinds.all;"},
     kOnGrid},
    {"walks", {"bvh/ray_pool.clh", "RAYA_WALKS, p->queued.truth", "RAYA_STEPS, p->queued.truth"}, kOnBvh},
    {"steps", {"shading/first_tests.clh", "all += steps;", "all += 2u * steps;"}, kOnBvh},
    {"pixel_cycles", {"ring/pixel_store.clh", "= cycles.lane[lane];", "= 0;"}, kOnGlass},
    {"discarded", {"torus/inject.cl", "2 * RAYA_DISCARDED", "2 * RAYA_PRIMARY"}, kOnTorus},
    {"steps",
     {"torus/trace_voxel.cl", "RAYA_STEPS, m & mask_not(has_flag(f, RAYA_STATE_FOUND))", "RAYA_WALKS, m"},
     kOnTorus},
    {"shadow_hits", {"torus/shade_packets.clh", "RAYA_SHADOW_HITS, stopped", "RAYA_LIT, stopped"}, kOnTorus}};

}  // namespace raya
