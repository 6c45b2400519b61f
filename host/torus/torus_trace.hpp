// Trace of the modelled torus: the work of each node in each superstep, in modelled time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/report/trace_file.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Records the supersteps of a render, in 16 bytes for each node and superstep.
class TorusTrace {
  public:
    explicit TorusTrace(const raya_torus& torus) : torus_(torus) {}

    void add_superstep(const SuperstepDetail& step);

    /// Adds a track for the supersteps and a track for each of `nodes` nodes to `trace`, from time 0 on, in the
    /// stepwise time of torus_time(): in each superstep a node computes and waits for the busiest node, then it sends
    /// and waits for the busiest link. Counters: live packets, load imbalance u of the superstep, words over the
    /// busiest link and mean words over a link. `result` must be of the same render. If `nodes` is 0, adds only a
    /// remark to the metadata.
    void add_to(TraceFile& trace, const TorusResult& result, std::size_t nodes) const;

  private:
    struct NodeStep {
        std::uint64_t cycles = 0;
        std::uint32_t busiest_link_words = 0;  // number of words over the node's busiest link
        std::uint32_t words = 0;               // number of words over all links of the node
    };
    class Timeline;

    raya_torus torus_;
    std::vector<std::vector<NodeStep>> steps_;  // [superstep][node]
};

}  // namespace raya
