// Time model of the nodes of the torus: cycles that events and messages cost on a transputer T805.
//
// Sources: [T] data sheet of the IMS T805 (SGS-Thomson, 1996), [?] assumed here.
//   - A cycle takes 40 ns [T: the 25 MHz part]. Typical cycles in single precision: addition, subtraction or comparison
//     6, multiplication 11, division 16, square root 119 [T].
//   - Every operation loads one operand from memory; the second is on the stack of the floating-point unit (FPU). A
//     load takes 2 cycles from the 4 KB on chip. The model's operands are in external memory, which takes three cycles
//     per word, so a load takes 2 cycles more [T]. The processor computes the operand's address in parallel with the
//     previous operation, at no cost [?].
//   - A move is a load and a store. A branch takes 6 cycles, including the load of its operand [?]. Without this load,
//     a branch that is taken takes 4 cycles [T].
//   - A message of w words takes 2 w + 19 cycles of the processor at each end; the link transfers the words itself [T].
//   - A link carries 1.7 MB/s (1 MB = 10^6 bytes) in one direction, 2.4 MB/s in both directions together [T].
// The data sheet warns that the FPU and the processor work in parallel, so that sums of instruction times are too high.
// The model does not correct the sums, because the error is unknown. The operations are counted from the same formulas
// as in model/budget.hpp. Here a multiply-accumulate is a multiplication and an addition; the first term of a sum is
// only a multiplication.
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
                               kT805SquareRootCycles = 119;
inline constexpr std::uint32_t kT805OperandCycles = 2 + 2, kT805StoreCycles = 2 + 2,
                               kT805MoveCycles = kT805OperandCycles + kT805StoreCycles, kT805BranchCycles = 6;
inline constexpr std::uint32_t kT805MessageCycles = 19, kT805MessageWordCycles = 2;

/// Packet that an event creates. kContribution is a contribution to the pixel: a separate return packet or, with
/// PacketCharge::one_return_per_ray, a part of the ray's return packet.
enum class CreatedPacket { kNone, kRay, kReturn, kContribution };

/// Numbers of 32-bit words that the time model charges for creating a packet and for transferring it over a link. The
/// default sizes are those of the kernels (kernels/shared/packet.h), which create a return packet for each contribution
/// of a ray. `one_return_per_ray` selects Yoshitani & Yamazaki's protocol instead: one return packet per ray other than
/// a shadow ray, sent after the ray's shadow rays, with the fields that their Table 1 marks (Layx, Layy, kind of ray,
/// luminance r, g, b).
struct PacketCharge {
    std::uint32_t ray_words = RAYA_PACKET_WORDS;
    bool one_return_per_ray = false;

    static constexpr std::uint32_t kRayReturnWords = 6;  // number of words of a return packet if one_return_per_ray
    std::uint32_t return_words() const {
        return one_return_per_ray ? kRayReturnWords : std::uint32_t{RAYA_RETURN_WORDS};
    }
    std::uint32_t words_of(CreatedPacket packet) const;
};

/// Numbers of additions and multiplications that one event costs on a T805. The divisions, square roots, moves and
/// branches of the event are those of its budget (model/budget.hpp).
struct T805Work {
    int event = 0;  // RAYA_* of kernels/shared/events.h
    std::uint32_t additions = 0, multiplications = 0;
    CreatedPacket creates = CreatedPacket::kNone;  // each word of the packet costs a store
};

/// Returns one entry for each kind of event, in the order of kernels/shared/events.h.
const std::array<T805Work, RAYA_EVENTS>& t805_work();

/// Returns the modelled cycles of one event of each kind, in the order of kernels/shared/events.h.
std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets = {});

/// Returns the processor cycles at one end (sender or receiver) of `messages` messages with `words` words in total.
std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words);

/// Returns the minimum time in ms for a link to carry `words` 32-bit words in one direction and `words_back` in the
/// opposite direction. Both directions are busy until one of them has finished.
double t805_link_ms(std::uint64_t words, std::uint64_t words_back);

}  // namespace raya
