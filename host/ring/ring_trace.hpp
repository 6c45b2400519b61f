// The modelled ring machine as a process of a trace: what each PE does when, in modelled time.
#pragma once
#include <cstddef>

#include "host/report/trace_file.hpp"
#include "host/ring/ring_result.hpp"
#include "host/ring/ring_settings.hpp"

namespace raya {

/// A track for the machine's phases and one for each of `pes` PEs (report/traced_pes.hpp), from the trace's time 0 on:
/// broadcast, trace, then rotations (or turns on the bus) and sums or comparisons, supersampling, then gather, each PE
/// waiting for the busiest one. Counters: rays alive, one for each PE that traces, and u of the phase. The times are
/// those of modelled_time() (machine/time_model.hpp), and end at its total: as it does, phases are taken as a whole
/// where a PE's memory holds only a block of its share; and a side's share of the arithmetic between neighbours is a
/// quarter of it. Where the machine's rates are not known, or `pes` is 0, there is no process, and the metadata says
/// why.
void add_ring_machine(TraceFile& trace, const RingSettings& settings, const RingResult& result, std::size_t pes);

}  // namespace raya
