// Time model of the nodes of the torus: cycles that events and messages cost on a transputer T805.
//
// Sources: [T] data sheet of the IMS T805 (SGS-Thomson, 1996), [?] assumed here.
//   - A cycle takes 40 ns [T: the 25 MHz part]. Typical cycles in single precision: addition, subtraction or comparison
//     6, multiplication 11, division 16, square root 119 [T].
//   - Every operation loads one operand from memory; the other is on the stack of the floating-point unit. A load takes
//     2 cycles [T], and 2 more because the operand is in external memory, which takes three cycles per word, and not in
//     the 4 KB on chip [T]. The processor computes the address in parallel with the previous operation, at no cost [?].
//   - A move is a load and a store. A branch takes 6 cycles, including the load of its operand [?]; without the load, a
//     branch that is taken takes 4 [T].
//   - A message of w words takes 2 w + 19 cycles of the processor at each end; the link transfers the words itself [T].
//   - A link carries 1.7 MB/s in one direction, 2.4 MB/s in both directions together [T].
// The data sheet warns that the FPU and the processor work in parallel, so that sums of instruction times are too high.
// By how much is unknown, so the model does not correct for it. The counts come from the same formulas as those of
// model/budget.hpp. Here a multiply-accumulate is a multiplication and an addition; the first term of a sum is only a
// multiplication.
#pragma once
#include <array>
#include <cstdint>

#include "kernels/shared/events.h"
#include "kernels/shared/packet.h"

namespace raya {

inline constexpr double kT805CycleNs = 40;
inline double t805_ms(std::uint64_t cycles) { return 1e-6 * kT805CycleNs * static_cast<double>(cycles); }
inline constexpr double kT805OneWayBytesPerS = 1.7e6, kT805BothWaysBytesPerS = 2.4e6;

inline constexpr std::uint32_t kT805AdditionCycles = 6, kT805MultiplicationCycles = 11, kT805DivisionCycles = 16,
                               kT805RootCycles = 119;
inline constexpr std::uint32_t kT805OperandCycles = 2 + 2, kT805StoreCycles = 2 + 2,
                               kT805MoveCycles = kT805OperandCycles + kT805StoreCycles, kT805BranchCycles = 6;
inline constexpr std::uint32_t kT805MessageCycles = 19, kT805MessageWordCycles = 2;

/// The packet that an event creates. kTerm: a contribution to the pixel, which is a return packet of its own, or part
/// of the ray's return packet if each ray has only one (PacketCharge::return_a_ray).
enum class Makes { kNothing, kRay, kReturn, kTerm };

/// The packet sizes, in 32-bit words, that the time model charges for the creation and the transfer of packets. By
/// default they are those of the kernels (kernels/shared/packet.h), where each contribution of a ray is a return
/// packet. The alternative is Yoshitani & Yamazaki's Table 1 and protocol: one return packet per ray, with the fields
/// that the table marks (Layx, Layy, kind of ray, luminance r, g, b).
struct PacketCharge {
    std::uint32_t ray_words = RAYA_PACKET_WORDS;
    bool return_a_ray = false;  // one return packet per ray other than a shadow ray, sent after the ray's shadow rays

    static constexpr std::uint32_t kWholeReturnWords = 6;
    std::uint32_t return_words() const { return return_a_ray ? kWholeReturnWords : std::uint32_t{RAYA_RETURN_WORDS}; }
    std::uint32_t words_of(Makes made) const;
};

/// Operations that one event of a kind costs on a T805. Its divisions, roots, moves and branches are those of its
/// budget (model/budget.hpp).
struct T805Work {
    int event = 0;  // RAYA_* of kernels/shared/events.h
    std::uint32_t additions = 0, multiplications = 0;
    Makes makes = Makes::kNothing;  // each word of this packet costs a store
};

/// One entry for each kind of event, in the order of kernels/shared/events.h.
const std::array<T805Work, RAYA_EVENTS>& t805_work();

/// Modelled cycles of one event of each kind.
std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets = {});

/// Processor cycles at one end (sender or receiver) of `messages` messages with `words` words in total.
std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words);

/// The minimum time in ms for a link to carry `words` 32-bit words in one direction and `words_back` in the other. Both
/// directions are busy until one of them has finished.
double t805_link_ms(std::uint64_t words, std::uint64_t words_back);

}  // namespace raya
