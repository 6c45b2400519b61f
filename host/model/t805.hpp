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
#include <optional>
#include <span>
#include <vector>

#include "host/model/machine.hpp"
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

/// Returns the modelled cycles of one event of each kind, in the order of kernels/shared/events.h.
std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets = {});

/// Returns the processor cycles at one end (sender or receiver) of `messages` messages with `words` words in total.
std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words);

/// Returns the minimum time in ms for a link to carry `words` 32-bit words in one direction and `words_back` in the
/// opposite direction. Both directions are busy until one of them has finished.
double t805_link_ms(std::uint64_t words, std::uint64_t words_back);

// Load balance and communication of the PEs, and modelled times. A modelled time is a number of cycles or words times
// the machine's time per cycle or per word.

/// Numbers of transfers of each kind, and total numbers of words in them. A word is a machine word of the modelled
/// machine, which holds one number.
struct Communication {
    std::uint64_t broadcasts = 0, broadcast_words = 0;        // host to all PEs
    std::uint64_t rotations = 0, rotation_words = 0;          // every PE to its neighbour
    std::uint64_t gathers = 0, gather_words = 0;              // all PEs to the host
    std::uint64_t transfers = 0, transfer_words = 0;          // one PE to another PE, over the bus
    std::uint64_t pe_broadcasts = 0, pe_broadcast_words = 0;  // one PE to all PEs, over the bus
};

/// The loads of P PEs, in modelled cycles, and their statistics.
struct Load {
    std::vector<std::uint64_t> per_pe;  // [PE]: load of the PE
    double mean = 0;
    std::uint64_t max = 0, min = 0;
    double imbalance = 0;   // u = (max - mean) / mean (Kohata & Ito 1993, Fig. 8); 0 if all loads are 0
    double speedup = 0;     // sum / max; P if all loads are 0
    double efficiency = 0;  // speedup / P
};

/// Computes the statistics of `per_pe`, which must not be empty.
Load load_of(std::vector<std::uint64_t> per_pe);

/// Modelled cycles in which the busiest PE filters and compares neighbouring pixels (model/budget.hpp), 0 without
/// anti-aliasing; and those for which it waits for other PEs in the turns of divided objects.
struct SmoothingCycles {
    std::uint64_t filter = 0, compare = 0, wait = 0;
};

/// Modelled times of a render on a ring, in milliseconds.
struct ModelledTime {
    double objects_ms = 0;  // broadcast of the scene by the host
    double compute_ms = 0;  // computation of the PEs: ray tracing, filter_ms, compare_ms and wait_ms
    double filter_ms = 0;   // part of compute_ms: means of neighbouring pixels
    double compare_ms = 0;  // part of compute_ms: comparisons with neighbouring pixels
    double wait_ms = 0;     // part of compute_ms: of the busiest PE, for other PEs in the turns of divided objects
    double communication_ms = 0;  // rotations of the ring; transfers and broadcasts of PEs on the bus
    double image_ms = 0;          // gather of the image by the host
    double display_ms = 0;        // display of the image by the host
    double total_ms = 0;          // objects_ms + compute_ms + communication_ms + image_ms + display_ms
    double factor = 1;            // MachineClock::cycle_factor, which the compute times above include
};

/// Modelled times of a torus whose nodes compute while its links transfer (host/torus/async_machine.hpp), milliseconds.
struct AsynchronousTime {
    double finish_ms = 0;         // time at which the last task has ended and the last return is delivered
    double processor_ms = 0;      // busy time of the busiest processor
    double links_ms = 0;          // busy time of the busiest direction of a link
    double port_ms = 0;           // maximum over the nodes: total time for which full ports blocked the main task
    std::uint64_t delivered = 0;  // number of delivered messages, including those from a node to itself
    std::uint64_t queue_max = 0;  // maximum number of rays that waited for a main task
};

/// Modelled times of a torus in milliseconds (host/torus/torus_result.hpp), without the transfer of the scene to the
/// nodes and of the image from the root to the host. The time of a real machine is between overlapped_ms and
/// stepwise_ms, because computation and communication overlap only in part.
struct TorusTime {
    double compute_ms = 0;     // computation time, maximum over the nodes
    double messages_ms = 0;    // processor time for sending and receiving, maximum over the nodes
    double processor_ms = 0;   // computation plus sending and receiving, maximum over the nodes
    double links_ms = 0;       // transfer time of both directions of a link, maximum over the links
    double overlapped_ms = 0;  // time if processors and links never wait for each other: a lower bound
    double stepwise_ms = 0;    // time if every superstep waits for its busiest node, then for its busiest link
    std::optional<AsynchronousTime> asynchronous{};  // times without supersteps; empty: not simulated
};

/// Returns the modelled time of a ring machine. `phases`: the loads of all PEs in each phase, not empty; the machine
/// waits for the busiest PE of each phase. The bus carries the words of one PE at a time, at the rate of a link and
/// with the overhead of a rotation. docs/architecture.md describes the model.
ModelledTime modelled_time(const MachineClock& clock, std::span<const Load> phases, const Communication& communication,
                           const SmoothingCycles& smoothing = {});

/// Returns the time, in milliseconds, of an exchange: its set-up, and `rotations` rotations or transfers between PEs in
/// which each link carries `words` words in total. Returns 0 if `rotations` is 0.
double exchange_ms(const MachineClock& clock, std::uint64_t rotations, double words);

/// Returns the time, in milliseconds, that a PE takes for `cycles` cycles of the budgets.
double compute_ms(const MachineClock& clock, double cycles);

}  // namespace raya
