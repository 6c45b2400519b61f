// What an event costs a DSP: an instruction budget, counted by hand from the formulas of kernels/README.md, for a
// processor with one multiply-accumulate a cycle and no hardware division or square root. Not fitted to any answer.
//
// The model, with its source: [P] printed in Kohata & Ito 1993, [?] ours.
//   - one multiply-accumulate, or one addition, multiplication or comparison, a cycle [P: 20 MFLOPS at 100 ns]; its
//     result can be used in the next cycle, and a negation is a multiply-subtract [?]
//   - two data buses, as DSPs of one multiply-accumulate a cycle have to feed it: two words a cycle come or go beside
//     the arithmetic. So a move costs a cycle only where a budget lists it: where no arithmetic is left to hide it [?]
//   - loops over objects and lights repeat in hardware; a conditional branch, call or return costs 3 cycles, its own
//     and two that the pipeline (fetch, decode, execute) loses, taken or not [?]
//   - division a / b: seed y = 1 / b from 256 words by the upper 8 bits of the significand, error < 2^-8; one Newton
//     step, e = 1 - b y, y + e y, squares it to < 2^-16, half a unit of a 16-bit significand; then a y [?]
//   - root of x: seed y = 1 / root from 256 words by the exponent's lowest bit and 7 of the significand, error < 2^-8;
//     one Newton step y (3/2 - (x/2) y y), error < 1.5 * 2^-16; then x y [?]
// The seeds' 512 words are not in the report's memory.
// The kernels round divisions and roots exactly; a DSP would leave their last bit as it comes. Neither is it counted
// that an assembler programmer would normalise by the reciprocal root itself and save the division.
#pragma once
#include <array>
#include <cstdint>

#include "host/model/machine.hpp"

namespace raya {

inline constexpr std::uint32_t kSeedCycles = 3;                        // cut the address out, read, set the exponent
inline constexpr std::uint32_t kDivisionCycles = kSeedCycles + 2 + 1;  // Newton step, a y
inline constexpr std::uint32_t kRootCycles = kSeedCycles + 1 + 3 + 1;  // x/2, Newton step, x y
inline constexpr std::uint32_t kBranchCycles = 3;

/// What one event of a kind takes.
struct Budget {
    int event = 0;                           // RAYA_* of kernels/shared/events.h
    std::uint32_t multiply_accumulates = 0;  // additions, multiplications, comparisons and fused ones alike
    std::uint32_t divisions = 0, roots = 0;
    std::uint32_t moves = 0;  // that no arithmetic hides
    std::uint32_t branches = 0;
    const char* why = "";  // what is in it, and what is left out
};

/// One for each kind of event, in their order.
const std::array<Budget, RAYA_EVENTS>& budgets();

std::uint32_t cycles_of(const Budget& budget);

/// Operations of many events.
struct Operations {
    std::uint64_t multiply_accumulates = 0, divisions = 0, roots = 0, moves = 0, branches = 0;
};
Operations operations_of(const EventCounts& events);

// Anti-aliasing has no events: each pixel of a PE's share takes the same.

/// Cycles in which a PE makes means of `pixels` pixels with their neighbours (kernels/ring/filter.cl).
std::uint64_t filter_cycles(std::uint64_t pixels);

/// Cycles in which a PE compares `pixels` pixels with their neighbours (kernels/ring/contrast.cl).
std::uint64_t compare_cycles(std::uint64_t pixels);

}  // namespace raya
