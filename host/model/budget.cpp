#include "host/model/budget.hpp"

#include <algorithm>

namespace raya {
namespace {

// Cost of a ray in addition to its intersection tests. Branches: call of the search for the nearest hit, and return
// from it. Moves: a counter and a pointer for each of the two object lists of the paper's machine, spheres and planes.
constexpr std::uint32_t kRayBranches = 2, kRayMoves = 4;

// Cost of a hit on a sphere. It does not include the sphere test, which ends with the sign of the discriminant, and the
// square root s. Operations: b - s, b + s: 2; comparison with the nearest hit so far: 1. Branches: 0 < t, nearer.
constexpr std::uint32_t kSphereHitOperations = 3, kSphereHitBranches = 2;

// The comment before each budget lists the terms of the event's formulas (names as in kernels/README.md), each with its
// number of multiply-accumulates. Then it lists the moves, each with its number, and the conditions of the branches.
// The comment "T805" lists the terms of the sums below it, in their order.
constexpr std::array<Budget, RAYA_EVENTS> kBudgets = {{
    // corner + j step: 3, + x step: 3, normalise: 3 + 3. Moves: conversion of j and x to numbers 2, origin 3, sum 3,
    // weight 1, store of the finished pixel 3. Branches: next pixel. Excluded: the 3 operations of the background for a
    // ray that hits nothing.
    {.event = RAYA_PRIMARY,
     .multiply_accumulates = 3 + 3 + 3 + 3,
     .divisions = 1,
     .roots = 1,
     .moves = 2 + 3 + 3 + 1 + 3 + kRayMoves,
     .branches = 1 + kRayBranches,
     // T805: corner + j step, + x step, normalise: |d|^2, times 1 / |d|
     .additions = 3 + 3 + 2,
     .multiplications = 3 + 3 + 3 + 3,
     .creates = CreatedPacket::kRay},
    // Counted only for the report: the work is charged to the shaded hits.
    {.event = RAYA_PRIMARY_HITS},
    // weight: 1. Moves: origin and direction, which replace those of the ray after all lights were processed. The
    // direction is charged to the shaded hit, because highlights need it too.
    {.event = RAYA_REFLECTED,
     .multiply_accumulates = 1,
     .moves = 6 + kRayMoves,
     .branches = kRayBranches,
     // T805: weight
     .multiplications = 1,
     .creates = CreatedPacket::kRay},
    // cos: 3, 1 - cos^2: 1, e^2: 1, g: 1, e cos - square root: 2, times N: 3, + e D: 3, normalise: 3 + 3, weight: 1,
    // P-: 3. Divisions: 1 / ior, normalise. Moves: push 7, pop 7. Branches: g < 0, level. Excluded: the 6 operations
    // and the division that end in total reflection or at the last level.
    {.event = RAYA_REFRACTED,
     .multiply_accumulates = 3 + 1 + 1 + 1 + 2 + 3 + 3 + 3 + 3 + 1 + 3,
     .divisions = 2,
     .roots = 2,
     .moves = 7 + 7 + kRayMoves,
     .branches = 2 + kRayBranches,
     // T805: cos, 1 - cos^2, e^2, g, e cos - square root, times N, + e D, normalise, weight, P-
     .additions = 2 + 1 + 0 + 1 + 1 + 0 + 3 + 2 + 0 + 3,
     .multiplications = 3 + 1 + 1 + 1 + 1 + 3 + 3 + (3 + 3) + 1 + 3,
     .creates = CreatedPacket::kRay},
    // arm: 3, N.arm: 3, |arm|^2: 3, direction: 3. Branches: faces away, occluded, next light. Excluded: the 6
    // operations for a surface that faces away.
    {.event = RAYA_SHADOW,
     .multiply_accumulates = 3 + 3 + 3 + 3,
     .divisions = 1,
     .roots = 1,
     .moves = kRayMoves,
     .branches = 3 + kRayBranches,
     // T805: arm, N.arm, |arm|^2, direction
     .additions = 3 + 2 + 2 + 0,
     .multiplications = 0 + 3 + 3 + 3,
     .creates = CreatedPacket::kRay},
    // Excluded: spheres hit beyond the light; too high if a plane occludes it.
    {.event = RAYA_SHADOW_HITS,
     .multiply_accumulates = kSphereHitOperations,
     .roots = 1,
     .branches = kSphereHitBranches,
     // T805: b - s, b + s, comparison with the nearest hit so far
     .additions = 2 + 1},
    // C - O: 3, b = c.D: 3, l = c - b D: 3, r^2 - l.l: 3. Branches: miss. The 12 operations hide the loads of its 4
    // words.
    {.event = RAYA_SPHERE_TESTS,
     .multiply_accumulates = 3 + 3 + 3 + 3,
     .branches = 1,
     // T805: C - O, b, l, r^2 - l.l
     .additions = 3 + 2 + 3 + 3,
     .multiplications = 0 + 3 + 3 + 3},
    // n.D: 3, d - n.O: 3, comparison of t with the nearest hit so far: 1. Branches: 0 < t, nearer.
    {.event = RAYA_PLANE_TESTS,
     .multiply_accumulates = 3 + 3 + 1,
     .divisions = 1,
     .branches = 2,
     // T805: n.D, d - n.O, comparison of t with the nearest hit so far
     .additions = 2 + 3 + 1,
     .multiplications = 3 + 3},
    // For each of four corners: minus O: 3, shear: 2, v compared with 0: 1. For each of the two edges that cross v = 0,
    // comparison of two products: 3. One test in twenty continues with (box: 4 * 3 + 4 * 6, plane: 7, t D: 3, inside
    // the box: 6) / 20. Moves: counter and pointer of the corners. Branches: one per edge, inside. Four edges: 3.5 in
    // scenes/polygons.nff. Excluded: two divisions per ray, once for all its polygons.
    {.event = RAYA_POLYGON_TESTS,
     .multiply_accumulates = 4 * (3 + 2 + 1) + 2 * 3 + (12 + 24 + 7 + 3 + 6) / 20,
     .moves = 2,
     .branches = 4 + 1,
     // T805: four corners minus O, sheared, compared with 0; for each of two edges, two products and a comparison; box
     // and plane in a twentieth of the tests
     .additions = 4 * (3 + 2 + 1) + 2 * 1 + (12 + 24 + 2 + 3 + 6) / 20,
     .multiplications = 4 * 2 + 2 * 2 + (3 + 3 + 3) / 20},
    // X - base: 3, to the nearest point: 3 + 3, z: 3, dz: 3, side: 3, dside: 3, radius: 1, dradius: 1, a: 1 + 3, b: 1 +
    // 3, c: 1 + 3, discriminant: 2. A third of the tests continues with (q, z and t twice, comparisons with 0, h and
    // the nearest hit: 9) / 3. These tests also need a square root and two divisions, which the budget charges as one
    // division to every test. Branches: miss; in a third of the tests three more. The 40 operations hide the loads of
    // its 10 words.
    {.event = RAYA_CONE_TESTS,
     .multiply_accumulates = 3 + 3 + 3 + 3 + 3 + 3 + 3 + 1 + 1 + 4 + 4 + 4 + 2 + 9 / 3,
     .divisions = 1,
     .branches = 1 + 3 / 3,
     // T805: X - base, to the nearest point, z, dz, side, dside, radius, dradius, a, b, c, discriminant; in a third of
     // the tests q, z and t twice, four comparisons
     .additions = 3 + (2 + 3) + 2 + 2 + 3 + 3 + 1 + 0 + 3 + 3 + 3 + 1 + (1 + 2 + 2 + 4) / 3,
     .multiplications = 0 + (3 + 3) + 3 + 3 + 3 + 3 + 1 + 1 + 4 + 4 + 4 + 2 + 1},
    // Sphere: kSphereHitOperations. P: 3, P - C: 3, normalise: 3 + 3, N.D: 3, orient: 3, margin: 3 comparisons + 1, P+:
    // 3, N.D of the oriented normal: 3, times -2: 1, R: 3, Kd C: 3, w A: 1, ambient: 3, kr: 1. Moves: t and number of
    // the nearest hit. Branches: any hit, sphere, cone, leaving, T > 0, kr > 0, level, pending ray. A plane needs no
    // square root and no normalisation, a cone 7 more operations. Excluded: spheres hit farther away, a patch's normal,
    // a checker's two divisions.
    {.event = RAYA_SHADED,
     .multiply_accumulates = kSphereHitOperations + 3 + 3 + 3 + 3 + 3 + 3 + 3 + 1 + 3 + 3 + 1 + 3 + 3 + 1 + 3 + 1,
     .divisions = 1,
     .roots = 1 + 1,
     .moves = 2,
     .branches = kSphereHitBranches + 8,
     // T805: sphere: square root and t, P, P - C, normalise, N.D, orient, margin, P+, N.D, times -2, R, Kd C, w A,
     // ambient, kr; the node sends the ambient term to the root as a return packet
     .additions = 3 + 3 + 3 + 2 + 2 + 3 + 3 + 3 + 2 + 0 + 3 + 0 + 0 + 3 + 0,
     .multiplications = 0 + 3 + 0 + (3 + 3) + 3 + 0 + 1 + 3 + 3 + 1 + 3 + 3 + 1 + 3 + 1,
     .creates = CreatedPacket::kReturn},
    // N.L: 3, times tint: 3, R.L: 3, times I: 3, added to the sum: 3. Branches: Ks > 0, R.L > 0.
    {.event = RAYA_LIT,
     .multiply_accumulates = 3 + 3 + 3 + 3 + 3,
     .branches = 2,
     // T805: N.L, times tint, R.L, times I, added to the sum; the shadow packet becomes a return packet
     .additions = 2 + 0 + 2 + 0 + 3,
     .multiplications = 3 + 3 + 3 + 3 + 3,
     .creates = CreatedPacket::kContribution},
    // x compared with 1: 1, log2 (number/power.clh): m - 1, m + 1, s^2, three terms, plus the exponent: 7, times n: 1,
    // exp2: integer part, f, six terms, times the power of two: 9, Ks: 1, added to three colours: 3. Moves: split of
    // significand and exponent 2, exponent to number 1, number to exponent 2. Branches: too dark to be visible. Both
    // series have the length for fp32; 16 bits would need one term less in each.
    {.event = RAYA_HIGHLIGHTS,
     .multiply_accumulates = 1 + 7 + 1 + 9 + 1 + 3,
     .divisions = 1,
     .moves = 2 + 1 + 2,
     .branches = 1,
     // T805: x compared with 1, log2, times n, exp2, Ks, added to three colours
     .additions = 1 + (2 + 0 + 3 + 1) + 0 + (1 + 1 + 6) + 0 + 3,
     .multiplications = 0 + (1 + 3 + 1) + 1 + (6 + 1) + 1 + 3},
    // 1 / D: three divisions; entry to and exit from the box: 6 planes x 2, and 4 comparisons; first voxel: 3 times (O
    // + t D, minus corner, times 1 / cell, integer part: 4); its far sides: 3 times (plane: 1, minus O: 1, times 1 / D:
    // 1). Moves: voxel numbers and signs of D. Branches: misses the box, sign of each component.
    {.event = RAYA_WALKS,
     .multiply_accumulates = 6 * 2 + 4 + 3 * 4 + 3 * 3,
     .divisions = 3,
     .moves = 6,
     .branches = 1 + 3,
     // T805: 6 planes, 4 comparisons, the first voxel, its far sides
     .additions = 6 + 4 + 3 * (1 + 1 + 1) + 3 * (1 + 1),
     .multiplications = 6 + 3 * 2 + 3 * 2},
    // Minimum of three: 2 comparisons, voxel: 1, next plane: 1, minus O: 1, times 1 / D: 1, nearest hit compared with
    // the voxel's far side: 1. Moves: start and end of the voxel's list. Branches: axis 2, left the box, done.
    // Amanatides & Woo 1987, but the plane's position is recomputed, not added to.
    {.event = RAYA_STEPS,
     .multiply_accumulates = 2 + 1 + 1 + 1 + 1 + 1,
     .moves = 2,
     .branches = 2 + 1 + 1,
     // T805: minimum of three, voxel, next plane, minus O, times 1 / D, nearest hit compared with the voxel's far side
     .additions = 2 + 1 + 1 + 1 + 0 + 1,
     .multiplications = 0 + 0 + 1 + 0 + 1},
    // Direction of a primary ray: 12, as for RAYA_PRIMARY; its first voxel: 37, as for RAYA_WALKS. Moves: j and x 2,
    // origin 3, sum 3, first voxel 6. Branches: next pixel, first voxel 4, owner of the voxel. A ray that misses the
    // box is charged the same.
    {.event = RAYA_DISCARDED,
     .multiply_accumulates = 12 + 37,
     .divisions = 1 + 3,
     .roots = 1,
     .moves = 2 + 3 + 3 + 6,
     .branches = 1 + 4 + 1,
     // T805: the primary ray, then its first voxel
     .additions = 8 + 25,
     .multiplications = 12 + 18},
    // A ray taken up and put back by a ring PE that tests it against a part of the objects. Moves: origin 3, direction
    // 3,
    // nearest distance and object number 2, both stored 2. Branches: next ray, done.
    {.event = RAYA_RESUMED, .moves = 3 + 3 + 2 + 2, .branches = 2},
}};

constexpr bool are_in_order_of_events() {
    for (std::size_t i = 0; i < kBudgets.size(); ++i)
        if (kBudgets[i].event != static_cast<int>(i)) return false;
    return true;
}
static_assert(are_in_order_of_events());

}  // namespace

const std::array<Budget, RAYA_EVENTS>& budgets() { return kBudgets; }

std::uint32_t cycles_of(const Budget& b) {
    return b.multiply_accumulates + kDivisionCycles * b.divisions + kSquareRootCycles * b.roots + b.moves +
           kBranchCycles * b.branches;
}

Operations operations_of(const EventCounts& events) {
    Operations total;
    for (const Budget& b : kBudgets) {
        const std::uint64_t count = events[static_cast<std::size_t>(b.event)];
        total.multiply_accumulates += count * b.multiply_accumulates;
        total.divisions += count * b.divisions;
        total.roots += count * b.roots;
        total.moves += count * b.moves;
        total.branches += count * b.branches;
    }
    return total;
}

// Each colour component of a pixel takes four additions and one multiplication by 1/9. The two buses load both operands
// of an operation in parallel with arithmetic. But the result must be stored before the next operands are loaded, so
// each operation takes one move. Branches: one for each side of the pixel, to test whether a neighbour exists.
std::uint64_t filter_cycles(std::uint64_t pixels) {
    constexpr Budget kPixel = {.multiply_accumulates = 3 * (4 + 1), .moves = 3 * (4 + 1), .branches = 4};
    return pixels * cycles_of(kPixel);
}

// For each side of a pixel and colour component: clamp of both values to 0..1: 4, difference: 1, comparison with the
// threshold: 1. Branches for each side: one to test for a neighbour, one per component. Moves: store of the mark.
std::uint64_t compare_cycles(std::uint64_t pixels) {
    constexpr Budget kPixel = {.multiply_accumulates = 4 * 3 * (4 + 1 + 1), .moves = 1, .branches = 4 * (1 + 3)};
    return pixels * cycles_of(kPixel);
}

}  // namespace raya
