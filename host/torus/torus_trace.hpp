// Trace of the modelled torus: the work of each node in each superstep, in modelled time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/report/trace_file.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Adds a track for the supersteps and a track for each of `nodes` nodes to `trace`, from time 0 on, in the stepwise
/// time of torus_time(): in each superstep a node computes and waits for the busiest node, then it sends and waits for
/// the busiest link. Counters: live packets, load imbalance u of the superstep, words over the busiest link and mean
/// words over a link. `cycles`, [superstep][node], and `link_words`, [superstep][node][RAYA_LINKS], are those of the
/// same render (SuperstepDetail). If `nodes` is 0, adds only a remark to the metadata.
void add_torus_machine(TraceFile& trace, const raya_torus& torus, const TorusResult& result,
                       const std::vector<std::uint64_t>& cycles, const std::vector<std::uint64_t>& link_words,
                       std::size_t nodes);

}  // namespace raya
