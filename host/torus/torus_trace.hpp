// Traces of the modelled torus: packets as CSV (docs/architecture.md), and a trace of the work of each node in each
// superstep, in modelled time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "host/base/encoding.hpp"
#include "host/report/trace_file.hpp"
#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Writes packet records as CSV, in the order in which add() receives them. Takes about 60 bytes of memory for each ray
/// that was sent or whose child was sent.
class PacketTrace {
  public:
    PacketTrace();

    /// Adds a row. Throws std::out_of_range for an unknown kind of packet.
    void add(const PacketRecord& record);

    /// Returns the file, compressed with gzip. Must be called once, as the last call.
    std::string finish();

    std::uint64_t rows() const { return rows_; }

  private:
    std::uint64_t number_of(const RayId& ray);

    GzipText file_;
    std::string text_;  // rows that are not compressed yet
    std::unordered_map<RayId, std::uint64_t, RayIdHash> numbers_;
    std::uint64_t next_number_ = 0;  // rays and returns are numbered in the order of their first appearance
    std::uint64_t rows_ = 0;
};

/// Records the supersteps of a render, in 16 bytes for each node and superstep, and the packets of every
/// kPacketsEvery-th superstep, in 16 bytes each.
class TorusTrace {
  public:
    static constexpr std::size_t kMaxPackets = 20'000;  // in a trace
    static constexpr std::uint32_t kPacketsEvery = 16;

    explicit TorusTrace(const raya_torus& torus) : torus_(torus) {}

    void add_superstep(const SuperstepDetail& step);
    void add_packet(const PacketRecord& packet);  // ignores packets of other supersteps

    /// Adds a track for the supersteps and a track for each of `nodes` nodes to `trace`, from time 0 on, in the
    /// stepwise time of torus_time(): in each superstep a node computes and waits for the busiest node, then it sends
    /// and waits for the busiest link. Counters: live packets, load imbalance u of the superstep, words over the
    /// busiest link and mean words over a link. Flows: a random sample of the packets whose source and destination have
    /// a track. A flow ends at the earliest possible arrival: as many supersteps after its start as the packet's route
    /// has links. `result` must be of the same render. If `nodes` is 0, adds only a remark to the metadata.
    void add_to(TraceFile& trace, const TorusResult& result, std::size_t nodes) const;

  private:
    struct TracedPacket {
        std::uint32_t superstep, source, destination, kind;
    };
    struct NodeStep {
        std::uint64_t cycles = 0;
        std::uint32_t busiest_link_words = 0;  // number of words over the node's busiest link
        std::uint32_t words = 0;               // number of words over all links of the node
    };
    class Timeline;

    raya_torus torus_;
    std::vector<std::vector<NodeStep>> steps_;  // [superstep][node]
    std::vector<TracedPacket> packets_;
};

}  // namespace raya
