// Traces of the modelled torus: its packets as CSV (docs/packets.md), and what each node does in each superstep, in
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

/// "primary", "reflected", "refracted", "shadow" or "return"; std::logic_error for another kind.
const char* packet_kind_name(std::uint32_t kind);

/// Takes records one after another, as a PacketSink is given them. Keeps the compressed text and the rays' numbers,
/// which is most of it: up to 48 bytes for each ray and shadow ray that was sent or whose child was.
class PacketTrace {
  public:
    PacketTrace();

    /// One row. std::logic_error for a head that no packet has.
    void add(const PacketRecord& record);

    /// The whole file; the last that may be asked of the trace.
    std::string finish();

    std::uint64_t rows() const { return rows_; }

  private:
    GzipText file_;
    std::string text_;  // rows that are not compressed yet
    RayNumbers numbers_;
    std::uint64_t rows_ = 0;
};

/// Takes what happens in a render, by its sinks, and keeps 16 bytes for each node and superstep and a sample of at most
/// kMostPackets packets, each packet that it is told of with the same chance.
class TorusTrace {
  public:
    static constexpr std::size_t kMostPackets = 20'000;
    static constexpr std::uint32_t kPacketsEvery = 16;  // supersteps: reading all packets takes longer than the render

    explicit TorusTrace(const raya_torus& torus) : torus_(torus) {}

    void add_superstep(const SuperstepDetail& step);
    void add_packet(const PacketRecord& packet);

    /// A track for the supersteps and one for each of `nodes` nodes (report/traced_pes.hpp), from the trace's time 0
    /// on, in the stepwise time of torus_time(): in each superstep a node computes and waits for the busiest node, then
    /// its links move and it waits for the busiest link. Counters: packets alive, u of the superstep, words over the
    /// busiest link and over all links on average. Flows: packets of the sample that went between nodes shown; they
    /// arrive a superstep for each link on their way later, the earliest that they can. `result` and its load are those
    /// of the same render. No process where `nodes` is 0; the metadata says so.
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
