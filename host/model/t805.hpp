// Time model of the torus's nodes: cycles of events and messages on a transputer T805.
//
// Sources: [T] data sheet of the IMS T805 (SGS-Thomson, 1996), [?] assumed here.
//   - A cycle takes 40 ns [T: the 25 MHz part]. Typical cycles in single precision: addition, subtraction or comparison
//     6, multiplication 11, division 16, square root 119 [T].
//   - Every operation loads one operand from memory; the other is on the stack of the floating-point unit. A load takes
//     2 cycles [T], and 2 more because the operand is in external memory, at three cycles per word, and not in the 4 KB
//     on chip [T]. The processor computes the address in parallel with the previous operation, at no cost [?].
//   - A move is a load and a store. A branch takes 6 cycles, including the load of its operand [T: 4 for one taken; ?].
//   - A message of w words takes 2 w + 19 cycles of the processor at each end; the link transfers the words itself [T].
//   - A link carries 1.7 MB/s in one direction, 2.4 MB/s in both directions together [T].
// The data sheet warns that FPU and processor overlap, so that sums of instruction times are too high. The amount is
// unknown, so the model does not correct for it. Operations and branches are those of model/budget.hpp, which has the
// same formulas; here a multiply-accumulate is a multiplication and an addition, the first one of a sum only a
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

/// The packet that an event creates. A term is part of the return packet if each ray has only one.
enum class Makes { kNothing, kRay, kReturn, kTerm };

/// The charged sizes of packets in 32-bit words, for links and for the creation of packets. Default: the packets of the
/// kernels (kernels/shared/packet.h), where each contribution of a ray is a return packet. Alternative: Yoshitani &
/// Yamazaki's Table 1 and protocol, with one return packet per ray, of the fields that they mark: Layx, Layy, kind of
/// ray, luminance r, g, b.
struct PacketCharge {
    std::uint32_t ray_words = RAYA_PACKET_WORDS;
    bool return_a_ray = false;  // one return packet per ray that is not a shadow ray, after its shadow rays

    static constexpr std::uint32_t kWholeReturnWords = 6;
    std::uint32_t return_words() const { return return_a_ray ? kWholeReturnWords : std::uint32_t{RAYA_RETURN_WORDS}; }
    std::uint32_t words_of(Makes made) const;
};

/// The operations of one event of a kind, except the divisions, roots, moves and branches in its budget
/// (model/budget.hpp).
struct T805Work {
    int event = 0;  // RAYA_* of kernels/shared/events.h
    std::uint32_t additions = 0, multiplications = 0;
    Makes makes = Makes::kNothing;  // charged: the stores of the packet's words
};

/// One entry for each kind of event, in their order.
const std::array<T805Work, RAYA_EVENTS>& t805_work();

/// Modelled cycles of one event of each kind.
std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets = {});

/// Cycles of the processor at one end of `messages` messages with `words` words in total.
std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words);

/// The minimum time in ms in which a link carries `words` 32-bit words in one direction and `words_back` in the other:
/// both directions at once until one of them is finished.
double t805_link_ms(std::uint64_t words, std::uint64_t words_back);

}  // namespace raya
