// What a render on many ranks takes: measured seconds of one rank, what was counted of each rank's part, and a network
// of alpha and beta.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/ranks/ping.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Seconds of one render, by what they are spent on.
struct RankParts {
    double compute_s = 0;    // the device of the rank that has most to do
    double host_s = 0;       // rank 0's host, which no rank shares with it
    double exchange_s = 0;   // rotations of the ring; faces of the torus
    double collect_s = 0;    // pixels to rank 0; the status of all nodes to every rank, each superstep
    double broadcast_s = 0;  // the scene to the ranks, before a render's clock starts

    double render_s() const { return compute_s + host_s + exchange_s + collect_s; }
    double total_s() const { return render_s() + broadcast_s; }
    double communication_s() const { return exchange_s + collect_s + broadcast_s; }
    double share() const { return communication_s() / total_s(); }
};

/// Steps in which all of so many ranks can have heard of one another: log2, rounded up.
std::uint32_t rounds_of(std::uint32_t ranks);

/// What one rank took for a picture, measured; `spread` is what its device does for all PEs or nodes alike.
struct MeasuredWork {
    double trace_s = 0;   // the device, on rays
    double spread_s = 0;  // the device, on all else
    double host_s = 0;    // the rest of the render
};

/// The ring machine on so many ranks, counted.
struct RingPart {
    std::uint32_t ranks = 1, pes = 1;
    double imbalance = 0;         // u of the ranks' segments, by the loads of their PEs
    std::uint64_t rotations = 0;  // of the exchange
    double block_bytes = 0;       // of a PE: what leaves a rank at a rotation
    double image_bytes = 0, scene_bytes = 0;
};

/// `processors`: that the ranks have together, 1 .. ranks; fewer than ranks where they take turns.
///   compute   = (trace (1 + u) + spread) / processors
///   exchange  = rotations (alpha + beta block)
///   collect   = 2 (R - 1) alpha + beta image (R - 1) / R      pixels, then loads, of one rank after another
///   broadcast = ceil(log2 R) (alpha + beta scene)
/// One rank communicates nothing.
RankParts predict_ring(const MeasuredWork& one, const RingPart& part, const Network& network, double processors);

/// The torus on so many ranks, counted; sums over the supersteps, each of the rank that has most in it.
struct TorusPart {
    std::uint32_t ranks = 1, nodes = 1;
    std::uint32_t most_nodes = 1;  // of a rank
    double supersteps = 0;
    double cycles = 0, all_cycles = 0;  // modelled, of the rank; of all nodes
    double messages = 0, bytes = 0;     // one way: what the rank sends, or receives, where that is more
    double status_bytes = 0;            // of all nodes
    double scene_bytes = 0;
    double host_times = 1;  // as much for rank 0's host as on the machine that was measured
};

///   compute   = (trace cycles / all cycles + spread most nodes / nodes) ranks / processors
///   exchange  = messages alpha + bytes beta
///   collect   = supersteps (ceil(log2 R) alpha + beta status (R - 1) / R)
///   broadcast = (R - 1) alpha + beta scene (R - 1) / R
RankParts predict_torus(const MeasuredWork& one, const TorusPart& part, const Network& network, double processors);

/// The torus of `times` as many nodes as `part` has, each of whose nodes has been cut into so many, a rank for each:
/// supersteps grow with a side of the torus, times^(1/3); a node's cycles in a superstep and the bytes of its faces
/// shrink with its voxel, 1 / times and times^(-2/3) in all of a rank's; a host looks at the status of all nodes,
/// times^(4/3) in all. `part` is of one node a rank.
TorusPart cut_further(const TorusPart& part, std::uint32_t times);

/// Counts a TorusPart while the machine runs.
class BrickCounter {
  public:
    /// Bricks of ranks_of_nodes(). UserError for more ranks than nodes.
    BrickCounter(const raya_torus& torus, std::uint32_t ranks);

    /// One superstep: `cycles` [node], `link_words` [node][RAYA_LINKS].
    void add(const std::vector<std::uint64_t>& cycles, const std::vector<std::uint64_t>& link_words);

    /// Without status, scene and host.
    const TorusPart& part() const { return part_; }

  private:
    struct Traffic {
        double messages = 0, bytes = 0;
    };
    raya_torus torus_;
    std::vector<std::uint32_t> rank_of_;
    TorusPart part_;
};

/// The first of so many ranks, in ascending order, on which communication takes half of the time or more; 0: on none.
std::uint32_t half_at(std::span<const std::uint32_t> ranks, std::span<const RankParts> parts);

}  // namespace raya
