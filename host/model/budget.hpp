// Instruction budgets: the cycles that each event costs on a DSP with one multiply-accumulate per cycle and no hardware
// division or square root. The operations were counted by hand from the formulas in kernels/README.md, not fitted to
// published times.
//
// Assumptions, each with its source: [P] printed in Kohata & Ito 1993, [?] assumed here.
//   - One multiply-accumulate, addition, multiplication or comparison takes one cycle [P: 20 MFLOPS at 100 ns]. Its
//     result can be used in the next cycle. A negation is a multiply-subtract [?].
//   - Two data buses transfer two words per cycle in parallel with the arithmetic, because one multiply-accumulate per
//     cycle requires two operands per cycle. A move costs a cycle only if no arithmetic runs in parallel with it. The
//     budgets contain only such moves [?].
//   - Loops over objects and lights are hardware loops without overhead. A conditional branch, call or return costs 3
//     cycles, taken or not: one to execute it and two that are lost in the pipeline (fetch, decode, execute) [?].
//   - Division a / b: seed y = 1 / b from a table of 256 words indexed by the upper 8 bits of the significand, error
//     < 2^-8; one Newton step, e = 1 - b y, y + e y, squares the error to < 2^-16, half a unit of a 16-bit significand;
//     then a y [?].
//   - Square root of x: seed y = 1 / sqrt(x) from a table of 256 words indexed by the lowest bit of the exponent and 7
//     bits of the significand, error < 2^-8; one Newton step y (3/2 - (x/2) y y), error < 1.5 * 2^-16; then x y [?].
// The memory sizes in the report do not include the 512 words of the two seed tables.
// The kernels round divisions and square roots correctly; a DSP would not correct the last bit. The model also ignores
// that an assembly programmer would normalise a vector by the reciprocal square root and save the division.
#pragma once
#include <array>
#include <cstdint>

#include "host/model/machine.hpp"
#include "host/model/t805.hpp"

namespace raya {

inline constexpr std::uint32_t kSeedCycles = 3;  // extract the table index, read the table, set the exponent
inline constexpr std::uint32_t kDivisionCycles = kSeedCycles + 2 + 1;        // seed, Newton step, a y
inline constexpr std::uint32_t kSquareRootCycles = kSeedCycles + 1 + 3 + 1;  // seed, x/2, Newton step, x y
inline constexpr std::uint32_t kBranchCycles = 3;

/// Numbers of operations that one event costs. `roots`: number of square roots.
struct Budget {
    int event = 0;                           // RAYA_* of kernels/shared/events.h
    std::uint32_t multiply_accumulates = 0;  // additions, multiplications, comparisons and multiply-accumulates
    std::uint32_t divisions = 0, roots = 0;
    std::uint32_t moves = 0;  // moves without arithmetic in parallel
    std::uint32_t branches = 0;
    // On a T805 (host/model/t805.hpp), instead of multiply-accumulates. Each word of a created packet costs a store.
    std::uint32_t additions = 0, multiplications = 0;
    CreatedPacket creates = CreatedPacket::kNone;
};

/// Returns the budgets of all events, in the order of kernels/shared/events.h.
const std::array<Budget, RAYA_EVENTS>& budgets();

/// Returns the cycles of one event with this budget.
std::uint32_t cycles_of(const Budget& budget);

/// Total numbers of operations of many events. The members are those of Budget.
struct Operations {
    std::uint64_t multiply_accumulates = 0, divisions = 0, roots = 0, moves = 0, branches = 0;
};
Operations operations_of(const EventCounts& events);

// The kernels count no events of anti-aliasing, because it costs the same for every pixel.

/// Returns a PE's modelled cycles for filtering `pixels` pixels with their neighbours (kernels/ring/filter.cl).
std::uint64_t filter_cycles(std::uint64_t pixels);

/// Returns a PE's modelled cycles for comparing `pixels` pixels with their neighbours (kernels/ring/contrast.cl).
std::uint64_t compare_cycles(std::uint64_t pixels);

}  // namespace raya
