#include "host/model/budget.hpp"

namespace raya {
namespace {

// What every ray takes beside its tests: call of the search and return from it; counter and pointer of the two lists
// that the paper's machine has, spheres and planes.
constexpr std::uint32_t kRayBranches = 2, kRayMoves = 4;

// The root of a sphere that was pierced is charged to the hit, not to the test, which ends with the discriminant's
// sign: (b - s, b + s: 2, against the nearest so far: 1), branches 0 < t and nearer.
constexpr std::uint32_t kPiercedOperations = 3, kPiercedBranches = 2;

constexpr std::array<Budget, RAYA_EVENTS> kBudgets = {{
    // corner + j step: 3, + x step: 3, normalise: 3 + 3. Moves: j and x to numbers 2, origin 3, sum 3, weight 1, and
    // the pixel stored when it is done 3. Branches: next pixel
    {.event = RAYA_PRIMARY,
     .multiply_accumulates = 3 + 3 + 3 + 3,
     .divisions = 1,
     .roots = 1,
     .moves = 2 + 3 + 3 + 1 + 3 + kRayMoves,
     .branches = 1 + kRayBranches,
     .why = "direction through the pixel, normalised; the pixel stored. Without the 3 operations of the background, "
            "where a ray of the tree hits nothing"},
    {.event = RAYA_PRIMARY_HITS, .why = "a count for the report alone: what follows is in the shaded hits"},
    // weight: 1. Moves: origin and direction, which the lights needed until now
    {.event = RAYA_REFLECTED,
     .multiply_accumulates = 1,
     .moves = 6 + kRayMoves,
     .branches = kRayBranches,
     .why = "weight; the direction is among the shaded hit's operations, as highlights need it too"},
    // cos: 3, 1 - cos^2: 1, e^2: 1, g: 1, e cos - root: 2, times N: 3, + e D: 3, normalise: 3 + 3, weight: 1, P-: 3.
    // Divisions: 1 / ior, normalise. Moves: onto the stack 7, off it 7. Branches: g < 0, level
    {.event = RAYA_REFRACTED,
     .multiply_accumulates = 3 + 1 + 1 + 1 + 2 + 3 + 3 + 3 + 3 + 1 + 3,
     .divisions = 2,
     .roots = 2,
     .moves = 7 + 7 + kRayMoves,
     .branches = 2 + kRayBranches,
     .why = "Snell, direction, normalised; on the stack and off it. Without the 6 operations and the division that end "
            "in total reflection or at the last level"},
    // arm: 3, N.arm: 3, |arm|^2: 3, direction: 3. Branches: faces away, stopped, next light
    {.event = RAYA_SHADOW,
     .multiply_accumulates = 3 + 3 + 3 + 3,
     .divisions = 1,
     .roots = 1,
     .moves = kRayMoves,
     .branches = 3 + kRayBranches,
     .why = "arm to the light and its length. Without the 6 operations that find that the surface faces away"},
    {.event = RAYA_SHADOW_HITS,
     .multiply_accumulates = kPiercedOperations,
     .roots = 1,
     .branches = kPiercedBranches,
     .why =
         "the root of the sphere that stops the ray. Without spheres that are pierced beyond the light, and too much "
         "where a plane stops it"},
    // C - O: 3, b = c.D: 3, l = c - b D: 3, r^2 - l.l: 3. Branches: passes by
    {.event = RAYA_SPHERE_TESTS,
     .multiply_accumulates = 3 + 3 + 3 + 3,
     .branches = 1,
     .why = "to the sign of the discriminant. Its 4 words come beside 12 operations"},
    // n.D: 3, d - n.O: 3, t against the nearest so far: 1. Branches: 0 < t, nearer
    {.event = RAYA_PLANE_TESTS,
     .multiply_accumulates = 3 + 3 + 1,
     .divisions = 1,
     .branches = 2,
     .why = "to t, which has to be known before the ray can be said to miss"},
    // four corners, each minus O: 3, sheared: 2, v against 0: 1; two of the edges cross v = 0 and compare two products:
    // 3;
    // of twenty tests one goes on: (box: 4 * 3 + 4 * 6, plane: 7, t D: 3, in the box: 6) / 20. Moves: the corners'
    // counter
    // and pointer. Branches: an edge's one for each, inside
    {.event = RAYA_POLYGON_TESTS,
     .multiply_accumulates = 4 * (3 + 2 + 1) + 2 * 3 + (12 + 24 + 7 + 3 + 6) / 20,
     .moves = 2,
     .branches = 4 + 1,
     .why = "an outline of four edges (3.5 in scenes/polygons.nff), and for one test in twenty its plane; without the "
            "ray's own two divisions, once for all its polygons"},
    // X - base: 3, to the nearest point: 3 + 3, z: 3, dz: 3, side: 3, dside: 3, radius: 1, dradius: 1, a: 1 + 3,
    // b: 1 + 3, c: 1 + 3, discriminant: 2; a third of the tests goes on: (q, z and t twice, against 0, h and the
    // nearest: 9) / 3, a root and two divisions, as one division. Branches: passes by, and a third of three
    {.event = RAYA_CONE_TESTS,
     .multiply_accumulates = 3 + 3 + 3 + 3 + 3 + 3 + 3 + 1 + 1 + 4 + 4 + 4 + 2 + 9 / 3,
     .divisions = 1,
     .branches = 1 + 3 / 3,
     .why = "to the sign of the discriminant; three tests in ten (scenes/cones.nff) go on to a root and two divisions, "
            "which together are charged as one division to every test. Its 10 words come beside 40 operations"},
    // sphere: see above; P: 3, P - C: 3, normalise: 3 + 3, N.D: 3, turned: 3, margin: 3 comparisons + 1, P+: 3,
    // N.D of the turned normal: 3, times -2: 1, R: 3, Kd C: 3, w A: 1, ambient: 3, kr: 1. Moves: t and number of the
    // nearest. Branches: hit at all, sphere, cone, leaving, T > 0, kr > 0, level, does a ray wait
    {.event = RAYA_SHADED,
     .multiply_accumulates = kPiercedOperations + 3 + 3 + 3 + 3 + 3 + 3 + 3 + 1 + 3 + 3 + 1 + 3 + 3 + 1 + 3 + 1,
     .divisions = 1,
     .roots = 1 + 1,
     .moves = 2,
     .branches = kPiercedBranches + 8,
     .why =
         "root of the sphere, point, normal, margin, mirror direction, tint, ambient term, for a hit of a sphere: a "
         "plane needs no root and no normalising, a cone 7 operations more. Without spheres that are pierced but not "
         "nearest, a patch's normal, and a checker's two divisions"},
    // N.L: 3, times tint: 3, R.L: 3, times I: 3, into the sum: 3. Branches: Ks > 0, R.L > 0
    {.event = RAYA_LIT,
     .multiply_accumulates = 3 + 3 + 3 + 3 + 3,
     .branches = 2,
     .why = "diffuse term, the highlight's cosine, times the light, into the pixel"},
    // x against 1: 1, log2 (number/power.clh): m - 1, m + 1, s^2, three of the series, with the exponent: 7; times n:
    // 1;
    // exp2: whole, f, six of the series, times the power of two: 9; Ks: 1, to three colours: 3. Moves: significand and
    // exponent apart 2, exponent to number 1, number to exponent 2. Branches: too dark to be seen
    {.event = RAYA_HIGHLIGHTS,
     .multiply_accumulates = 1 + 7 + 1 + 9 + 1 + 3,
     .divisions = 1,
     .moves = 2 + 1 + 2,
     .branches = 1,
     .why = "x^n as 2^(n log2 x); both series have fp32's length, 16 bits would do with one term less each"},
    // 1 / D: three divisions; into and out of the box: 6 planes of 2 and 4 comparisons; the first voxel: 3 of (O + t D,
    // minus corner, times 1 / cell, whole: 4); its far sides: 3 of (plane: 1, minus O: 1, times 1 / D: 1). Moves: voxel
    // numbers and signs of D. Branches: misses the box, and the sign of each component
    {.event = RAYA_WALKS,
     .multiply_accumulates = 6 * 2 + 4 + 3 * 4 + 3 * 3,
     .divisions = 3,
     .moves = 6,
     .branches = 1 + 3,
     .why = "a ray is clipped to the box and finds its first voxel"},
    // smallest of three: 2 comparisons, voxel: 1, next plane: 1, minus O: 1, times 1 / D: 1, nearest hit against the
    // voxel's far side: 1. Moves: start and end of the voxel's list. Branches: which axis 2, left the box, done
    {.event = RAYA_STEPS,
     .multiply_accumulates = 2 + 1 + 1 + 1 + 1 + 1,
     .moves = 2,
     .branches = 2 + 1 + 1,
     .why = "the next voxel (Amanatides & Woo 1987, with the plane's place made anew in place of their addition)"},
    // a primary ray's direction: 12, and its first voxel: 37, as above. Moves: j and x 2, origin 3, sum 3; the
    // walk's 6.
    // Branches: next pixel, those of the walk, whose voxel it is
    {.event = RAYA_DISCARDED,
     .multiply_accumulates = 12 + 37,
     .divisions = 1 + 3,
     .roots = 1,
     .moves = 2 + 3 + 3 + 6,
     .branches = 1 + 4 + 1,
     .why = "a primary ray and its first voxel, which is another node's: no packet. One that misses the box is charged "
            "as one that meets it"},
}};

constexpr bool budgets_in_order() {
    for (std::size_t i = 0; i < kBudgets.size(); ++i)
        if (kBudgets[i].event != static_cast<int>(i)) return false;
    return true;
}
static_assert(budgets_in_order());

}  // namespace

const std::array<Budget, RAYA_EVENTS>& budgets() { return kBudgets; }

std::uint32_t cycles_of(const Budget& b) {
    return b.multiply_accumulates + kDivisionCycles * b.divisions + kRootCycles * b.roots + b.moves +
           kBranchCycles * b.branches;
}

Operations operations_of(const EventCounts& events) {
    Operations sum;
    for (const Budget& b : kBudgets) {
        const std::uint64_t count = events[static_cast<std::size_t>(b.event)];
        sum.multiply_accumulates += count * b.multiply_accumulates;
        sum.divisions += count * b.divisions;
        sum.roots += count * b.roots;
        sum.moves += count * b.moves;
        sum.branches += count * b.branches;
    }
    return sum;
}

// A colour takes four additions and one multiplication by 1/9; both words of an addition come by the two buses beside
// it, but the sum has to go back before the next side's words come: one move for each. Branches: is there such a
// neighbour.
std::uint64_t filter_cycles(std::uint64_t pixels) {
    constexpr Budget kPixel = {.multiply_accumulates = 3 * (4 + 1), .moves = 3 * (4 + 1), .branches = 4};
    return pixels * cycles_of(kPixel);
}

// For each side and colour: both clamped to 0..1: 4, difference 1, with the threshold 1. Branches: is there such a
// neighbour, and one for each colour. One move for the mark.
std::uint64_t compare_cycles(std::uint64_t pixels) {
    constexpr Budget kPixel = {.multiply_accumulates = 4 * 3 * (4 + 1 + 1), .moves = 1, .branches = 4 * (1 + 3)};
    return pixels * cycles_of(kPixel);
}

}  // namespace raya
