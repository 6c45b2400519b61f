// What events and messages cost a transputer T805: the time model of the torus's nodes.
//
// Sources: [T] data sheet of the IMS T805 (SGS-Thomson, 1996), [?] ours.
//   - a cycle of 40 ns [T: the 25 MHz part]; single precision, typical cycles: addition, subtraction or comparison 6,
//     multiplication 11, division 16, square root 119 [T]
//   - every operation takes one operand from memory, the other is on the stack of the floating-point unit: 2 cycles to
//     load a number [T] and 2 more, as it lies in external memory, three cycles a word, and not in the 4 KB on chip
//     [T]. Its address is made by the processor beside the operation before, and costs nothing [?]
//   - a move is a load and a store; a branch, with the loading of what it decides on, 6 cycles [T: 4 for one taken; ?]
//   - a message of w words costs the processor 2 w + 19 cycles at either end; the link moves the words by itself [T]
//   - a link carries 1.7 MB/s one way alone, 2.4 MB/s with both ways together [T]
// The data sheet warns that FPU and processor overlap, so that sums of instruction times are too long; by how much is
// not known to us, and nothing is taken off for it. Operations and branches are those of machine/budget.hpp, whose
// formulas are the same; here a multiply-accumulate is a multiplication and an addition, the first one of a sum the
// former alone.
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

/// What packet an event makes: a term is part of a return where a ray has but one.
enum class Makes { kNothing, kRay, kReturn, kTerm };

/// What packets are charged for, in words of 32 bits on links and in their making. As it is, what is moved
/// (kernels/shared/packet.h): each contribution of a ray is a return. Or as Yoshitani & Yamazaki, Table 1 and protocol,
/// have it: one return for each ray, of the fields that they mark: Layx, Layy, kind of ray, luminance r, g, b.
struct PacketCharge {
    std::uint32_t ray_words = RAYA_PACKET_WORDS;
    bool return_a_ray = false;  // one return for each ray that is no shadow ray, when its shadow rays are done

    static constexpr std::uint32_t kWholeReturnWords = 6;
    std::uint32_t return_words() const { return return_a_ray ? kWholeReturnWords : std::uint32_t{RAYA_RETURN_WORDS}; }
    std::uint32_t words_of(Makes made) const;
};

/// What one event of a kind takes beside the divisions, roots, moves and branches of its budget (machine/budget.hpp).
struct T805Work {
    int event = 0;  // RAYA_* of kernels/shared/events.h
    std::uint32_t additions = 0, multiplications = 0;
    Makes makes = Makes::kNothing;  // the packet's words are stored
};

/// One for each kind of event, in their order.
const std::array<T805Work, RAYA_EVENTS>& t805_work();

/// Modelled cycles of one event of each kind.
std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets = {});

/// Cycles of the processor at one end of `messages` that have `words` in all.
std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words);

/// Shortest time in ms in which a link carries so many words of 32 bits one way and the other: both ways at once until
/// one of them is done.
double t805_link_ms(std::uint64_t words, std::uint64_t words_back);

}  // namespace raya
