// Traces of the modelled torus: packets as CSV (docs/packets.md), and the work of each node in each superstep, in
// modelled time.
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

/// Writes packet records as CSV, in the order in which add() receives them. Memory: the compressed text and, mostly,
/// RayNumbers with up to 48 bytes for each ray that was sent or had a child that was sent.
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
    static constexpr std::uint32_t kPacketsEvery = 16;  // supersteps; reading all packets takes longer than the render

    explicit TorusTrace(const raya_torus& torus) : torus_(torus) {}

    void add_superstep(const SuperstepDetail& step);
    void add_packet(const PacketRecord& packet);

    /// Adds a track for the supersteps and a track for each of `nodes` nodes to `trace`, from time 0 on, in the
    /// stepwise time of torus_time(): in each superstep a node computes and waits for the busiest node, then it sends
    /// and waits for the busiest link. Counters: live packets, load imbalance u of the superstep, words over the
    /// busiest link and mean words over a link. Flows: the sampled packets whose source and destination have a track;
    /// they arrive one superstep after departure for each link of their route, which is the earliest possible time.
    /// `result` must be of the same render. If `nodes` is 0, adds only a remark to the metadata.
    void add_to(TraceFile& trace, const TorusResult& result, std::size_t nodes) const;

  private:
    struct Sample {
        std::uint32_t superstep, source, destination, state, pixel;
    };
    struct NodeStep {
        std::uint64_t cycles = 0;
        std::uint32_t link_words = 0, words = 0;  // words over its busiest link, over all its links
    };
    class Timeline;

    raya_torus torus_;
    std::vector<std::vector<NodeStep>> steps_;  // [superstep][node]
    std::vector<Sample> packets_;
    std::uint64_t packets_seen_ = 0;
    SplitMix random_{0x7ace};
};

}  // namespace raya
