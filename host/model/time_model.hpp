// What PEs compute and send, how evenly it is spread (in the terms of the papers), and the modelled time: counted
// cycles and words, times what each takes on a machine.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/model/machine.hpp"

namespace raya {

/// Transfers and their words, counted where they were made. A word is the machine's: one number.
struct Communication {
    std::uint64_t broadcasts = 0, broadcast_words = 0;        // host to all PEs
    std::uint64_t rotations = 0, rotation_words = 0;          // every PE to its neighbour
    std::uint64_t gathers = 0, gather_words = 0;              // all PEs to the host
    std::uint64_t transfers = 0, transfer_words = 0;          // one PE to one other, over the bus
    std::uint64_t pe_broadcasts = 0, pe_broadcast_words = 0;  // one PE to all, over the bus
};

/// Loads of P PEs, in modelled cycles.
struct Load {
    std::vector<std::uint64_t> per_pe;
    double mean = 0;
    std::uint64_t max = 0, min = 0;
    double imbalance = 0;   // u = (max - mean) / mean (Kohata & Ito 1993, Fig. 8); 0 where there is no load
    double speedup = 0;     // sum / max
    double efficiency = 0;  // speedup / P
};

/// `per_pe` holds one load for each PE, at least one.
Load load_of(std::vector<std::uint64_t> per_pe);

/// Cycles that the busiest PE spends on the arithmetic between neighbours (machine/budget.hpp); 0 without
/// anti-aliasing.
struct SmoothingCycles {
    std::uint64_t filter = 0, compare = 0;
};

/// In milliseconds. Display is not in it.
struct ModelledTime {
    double objects_ms = 0;        // broadcast of the scene
    double compute_ms = 0;        // all that the PEs compute: tracing, filter_ms and compare_ms
    double filter_ms = 0;         // of compute_ms: means of neighbouring pixels
    double compare_ms = 0;        // of compute_ms: comparisons with neighbouring pixels
    double communication_ms = 0;  // rotations of the ring; transfers and broadcasts of PEs on the bus
    double image_ms = 0;          // the image to the host
    double total_ms = 0;          // objects, compute, communication, image
    double factor = 1;            // that compute_ms was multiplied by
};

/// Of a torus whose nodes compute while its links carry (host/torus/async_machine.hpp); in milliseconds.
struct AsynchronousTime {
    double finish_ms = 0;
    double processor_ms = 0, links_ms = 0;  // of the node and of the way of a link that are busy longest
    double port_ms = 0;                     // that a main task waited for room towards a link, the longest
    std::uint64_t delivered = 0;            // messages, those that stayed in their node among them
    std::uint64_t queue_max = 0;            // rays that waited for a main task, at most
};

/// Of a torus, in milliseconds (host/torus/torus_result.hpp). A real machine lies between `overlapped` and `stepwise`:
/// it neither overlaps all nor waits every time. The scene's way to the nodes and the image's way from the root to the
/// host are not in it.
struct TorusTime {
    double compute_ms = 0;     // of the node that computes most
    double messages_ms = 0;    // processor's part of sending and receiving, of the node that has most of it
    double processor_ms = 0;   // of the node that has most of both together
    double links_ms = 0;       // of the link that has most to carry, both ways
    double overlapped_ms = 0;  // from below: no processor and no link ever waits for another one
    double stepwise_ms = 0;    // every superstep waits for its busiest node, then for its busiest link
    std::optional<AsynchronousTime> asynchronous{};  // without supersteps, where that was simulated
};

/// Empty where the machine's rates are not known. The phases' loads, one at least, are those of all PEs; the machine
/// waits for the busiest PE of each phase. The bus carries one PE's words at a time, at the links' rate and with a
/// rotation's synchronisation (Machine). `factor` > 0 is for cycles that the budget does not see; who fits it has to
/// report it.
std::optional<ModelledTime> modelled_time(const Machine& machine, std::span<const Load> phases,
                                          const Communication& communication, double factor = 1,
                                          const SmoothingCycles& smoothing = {});

}  // namespace raya
