// Traces of the modelled torus: packets as CSV (docs/packets.md), and a trace of the work of each node in each
// superstep, in modelled time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/encoding.hpp"
#include "host/report/trace_file.hpp"
#include "host/scene/split_mix.hpp"
#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Returns "primary", "reflected", "refracted", "shadow" or "return". Throws std::logic_error for other kinds.
const char* packet_kind_name(std::uint32_t kind);

/// Writes packet records as CSV, in the order in which add() receives them. RayNumbers takes most of the memory, up to
/// 48 bytes for each ray that was sent or whose child was sent; the compressed text takes the remainder.
class PacketTrace {
  public:
    PacketTrace();

    /// Adds a row. Throws std::logic_error for an invalid packet head.
    void add(const PacketRecord& record);

    /// Returns the file, compressed with gzip. Must be called once, as the last call.
    std::string finish();

    std::uint64_t rows() const { return rows_; }

  private:
    GzipText file_;
    std::string text_;  // rows that are not compressed yet
    RayNumbers numbers_;
    std::uint64_t rows_ = 0;
};

/// Records the supersteps of a render, in 16 bytes for each node and superstep, and a uniform random sample of at most
/// kMaxPackets of the packets passed to add_packet().
class TorusTrace {
  public:
    static constexpr std::size_t kMaxPackets = 20'000;
    static constexpr std::uint32_t kPacketsEvery = 16;  // packets are recorded in every 16th superstep

    explicit TorusTrace(const raya_torus& torus) : torus_(torus) {}

    void add_superstep(const SuperstepDetail& step);
    void add_packet(const PacketRecord& packet);

    /// Adds a track for the supersteps and a track for each of `nodes` nodes to `trace`, from time 0 on, in the
    /// stepwise time of torus_time(): in each superstep a node computes and waits for the busiest node, then it sends
    /// and waits for the busiest link. Counters: live packets, load imbalance u of the superstep, words over the
    /// busiest link and mean words over a link. Flows: the sampled packets whose source and destination have a track.
    /// A flow ends at the earliest possible arrival: as many supersteps after its start as the packet's route has
    /// links. `result` must be of the same render. If `nodes` is 0, adds only a remark to the metadata.
    void add_to(TraceFile& trace, const TorusResult& result, std::size_t nodes) const;

  private:
    struct SampledPacket {
        std::uint32_t superstep, source, destination, state, pixel;
    };
    struct NodeStep {
        std::uint64_t cycles = 0;
        std::uint32_t busiest_link_words = 0;  // number of words over the node's busiest link
        std::uint32_t words = 0;               // number of words over all links of the node
    };
    class Timeline;

    raya_torus torus_;
    std::vector<std::vector<NodeStep>> steps_;  // [superstep][node]
    std::vector<SampledPacket> packets_;
    std::uint64_t packets_seen_ = 0;
    SplitMix random_{0x7ace};
};

}  // namespace raya
