#include "host/model/t805.hpp"

#include <algorithm>

#include "host/model/budget.hpp"

namespace raya {
namespace {

// Each comment lists the terms of the sums below it, in the order of the sums. model/budget.cpp explains the terms.
constexpr std::array<T805Work, RAYA_EVENTS> kWork = {{
    // corner + j step, + x step, normalise: |d|^2, times 1 / |d|
    {.event = RAYA_PRIMARY, .additions = 3 + 3 + 2, .multiplications = 3 + 3 + 3 + 3, .creates = CreatedPacket::kRay},
    {.event = RAYA_PRIMARY_HITS},
    // weight
    {.event = RAYA_REFLECTED, .multiplications = 1, .creates = CreatedPacket::kRay},
    // cos, 1 - cos^2, e^2, g, e cos - square root, times N, + e D, normalise, weight, P-
    {.event = RAYA_REFRACTED,
     .additions = 2 + 1 + 0 + 1 + 1 + 0 + 3 + 2 + 0 + 3,
     .multiplications = 3 + 1 + 1 + 1 + 1 + 3 + 3 + (3 + 3) + 1 + 3,
     .creates = CreatedPacket::kRay},
    // arm, N.arm, |arm|^2, direction
    {.event = RAYA_SHADOW,
     .additions = 3 + 2 + 2 + 0,
     .multiplications = 0 + 3 + 3 + 3,
     .creates = CreatedPacket::kRay},
    // b - s, b + s, comparison with the nearest hit so far
    {.event = RAYA_SHADOW_HITS, .additions = 2 + 1},
    // C - O, b, l, r^2 - l.l
    {.event = RAYA_SPHERE_TESTS, .additions = 3 + 2 + 3 + 3, .multiplications = 0 + 3 + 3 + 3},
    // n.D, d - n.O, comparison of t with the nearest hit so far
    {.event = RAYA_PLANE_TESTS, .additions = 2 + 3 + 1, .multiplications = 3 + 3},
    // four corners minus O, sheared, compared with 0; for each of two edges, two products and a comparison; box and
    // plane in a twentieth of the tests
    {.event = RAYA_POLYGON_TESTS,
     .additions = 4 * (3 + 2 + 1) + 2 * 1 + (12 + 24 + 2 + 3 + 6) / 20,
     .multiplications = 4 * 2 + 2 * 2 + (3 + 3 + 3) / 20},
    // X - base, to the nearest point, z, dz, side, dside, radius, dradius, a, b, c, discriminant; in a third of the
    // tests q, z and t twice, four comparisons
    {.event = RAYA_CONE_TESTS,
     .additions = 3 + (2 + 3) + 2 + 2 + 3 + 3 + 1 + 0 + 3 + 3 + 3 + 1 + (1 + 2 + 2 + 4) / 3,
     .multiplications = 0 + (3 + 3) + 3 + 3 + 3 + 3 + 1 + 1 + 4 + 4 + 4 + 2 + 1},
    // sphere: square root and t, P, P - C, normalise, N.D, orient, margin, P+, N.D, times -2, R, Kd C, w A, ambient,
    // kr; the node sends the ambient term to the root as a return packet
    {.event = RAYA_SHADED,
     .additions = 3 + 3 + 3 + 2 + 2 + 3 + 3 + 3 + 2 + 0 + 3 + 0 + 0 + 3 + 0,
     .multiplications = 0 + 3 + 0 + (3 + 3) + 3 + 0 + 1 + 3 + 3 + 1 + 3 + 3 + 1 + 3 + 1,
     .creates = CreatedPacket::kReturn},
    // N.L, times tint, R.L, times I, added to the sum; the shadow packet becomes a return packet
    {.event = RAYA_LIT,
     .additions = 2 + 0 + 2 + 0 + 3,
     .multiplications = 3 + 3 + 3 + 3 + 3,
     .creates = CreatedPacket::kContribution},
    // x compared with 1, log2, times n, exp2, Ks, added to three colours
    {.event = RAYA_HIGHLIGHTS,
     .additions = 1 + (2 + 0 + 3 + 1) + 0 + (1 + 1 + 6) + 0 + 3,
     .multiplications = 0 + (1 + 3 + 1) + 1 + (6 + 1) + 1 + 3},
    // 6 planes, 4 comparisons, the first voxel, its far sides
    {.event = RAYA_WALKS, .additions = 6 + 4 + 3 * (1 + 1 + 1) + 3 * (1 + 1), .multiplications = 6 + 3 * 2 + 3 * 2},
    // minimum of three, voxel, next plane, minus O, times 1 / D, nearest hit compared with the voxel's far side
    {.event = RAYA_STEPS, .additions = 2 + 1 + 1 + 1 + 0 + 1, .multiplications = 0 + 0 + 1 + 0 + 1},
    // the primary ray, then its first voxel
    {.event = RAYA_DISCARDED, .additions = 8 + 25, .multiplications = 12 + 18},
}};

constexpr bool work_in_order() {
    for (std::size_t i = 0; i < kWork.size(); ++i)
        if (kWork[i].event != static_cast<int>(i)) return false;
    return true;
}
static_assert(work_in_order());

std::uint32_t cycles_of(const T805Work& work, const Budget& budget, const PacketCharge& packets) {
    // Number of operations that load an operand.
    const std::uint32_t operations = work.additions + work.multiplications + budget.divisions + budget.roots;
    return kT805AdditionCycles * work.additions + kT805MultiplicationCycles * work.multiplications +
           kT805DivisionCycles * budget.divisions + kT805SquareRootCycles * budget.roots +
           kT805OperandCycles * operations + kT805MoveCycles * budget.moves +
           kT805StoreCycles * packets.words_of(work.creates) + kT805BranchCycles * budget.branches;
}

}  // namespace

const std::array<T805Work, RAYA_EVENTS>& t805_work() { return kWork; }

std::uint32_t PacketCharge::words_of(CreatedPacket packet) const {
    switch (packet) {
        case CreatedPacket::kRay:
            return ray_words;
        case CreatedPacket::kReturn:
            return return_words();
        case CreatedPacket::kContribution:
            return one_return_per_ray ? 0 : return_words();
        case CreatedPacket::kNone:
            break;
    }
    return 0;
}

std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets) {
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};
    for (std::size_t event = 0; event < cycles.size(); ++event)
        cycles[event] = cycles_of(kWork[event], budgets()[event], packets);
    return cycles;
}

std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words) {
    return kT805MessageCycles * messages + kT805MessageWordCycles * words;
}

double t805_link_ms(std::uint64_t words, std::uint64_t words_back) {
    constexpr double kMsPerS = 1e3, kBytesPerWord = 4;
    const auto [less, more] = std::minmax(words, words_back);
    return kMsPerS * kBytesPerWord *
           (2 * static_cast<double>(less) / kT805BothWaysBytesPerS +
            static_cast<double>(more - less) / kT805OneWayBytesPerS);
}

}  // namespace raya
