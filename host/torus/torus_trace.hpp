// Traces of the modelled torus: packets as CSV (docs/packets.md), and the work of nodes by superstep in modelled time.
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

/// "primary", "reflected", "refracted", "shadow" or "return". Throws std::logic_error for other kinds.
const char* packet_kind_name(std::uint32_t kind);

/// Writes packet records as CSV, in the order of a PacketSink. Memory: the compressed text and, dominating, the table
/// of ray numbers, up to 48 bytes for each ray that was sent or whose child was.
class PacketTrace {
  public:
    PacketTrace();

    /// Adds a row. Throws std::logic_error for an invalid packet head.
    void add(const PacketRecord& record);

    /// Returns the whole file. To be called once, as the last call.
    std::string finish();

    std::uint64_t rows() const { return rows_; }

  private:
    GzipText file_;
    std::string text_;  // rows that are not compressed yet
    RayNumbers numbers_;
    std::uint64_t rows_ = 0;
};

/// Records the supersteps and packets of a render: 16 bytes for each node and superstep, and a uniform random sample of
/// at most kMaxPackets of the packets added.
class TorusTrace {
  public:
    static constexpr std::size_t kMaxPackets = 20'000;
    static constexpr std::uint32_t kPacketsEvery = 16;  // supersteps: reading all packets takes longer than the render

    explicit TorusTrace(const raya_torus& torus) : torus_(torus) {}

    void add_superstep(const SuperstepDetail& step);
    void add_packet(const PacketRecord& packet);

    /// Adds a track for the supersteps and one for each of `nodes` nodes (host/report/trace_file.hpp), from time 0 on,
    /// in the stepwise time of torus_time(): in each superstep a node computes and waits for the busiest node, then
    /// sends and waits for the busiest link. Counters: live packets, u of the superstep, words over the busiest link
    /// and mean words of a link. Flows: sampled packets between nodes that are shown, arriving one superstep later for
    /// each link of their route, the earliest time possible. `result` must be of the same render. Adds only a remark to
    /// the metadata if `nodes` is 0.
    void add_to(TraceFile& trace, const TorusResult& result, std::size_t nodes) const;

  private:
    struct Sample {
        std::uint32_t superstep, source, destination, state, pixel;
    };
    struct NodeStep {
        std::uint64_t cycles = 0;
        std::uint32_t link_words = 0, words = 0;  // over its busiest link, over all its links
    };
    class Timeline;

    raya_torus torus_;
    std::vector<std::vector<NodeStep>> steps_;  // [superstep][node]
    std::vector<Sample> packets_;
    std::uint64_t packets_seen_ = 0;
    SplitMix random_{0x7ace};
};

}  // namespace raya
