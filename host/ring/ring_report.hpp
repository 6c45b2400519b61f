// The ring machine's part of a render report.
#pragma once
#include "host/report/render_report.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/ring_result.hpp"

namespace raya {

/// Returns the modelled time of a render.
ModelledTime ring_time(const RingSettings& settings, const RingResult& result);

/// Returns accelerator, anti-aliasing, communication, operations and modelled time.
MachineReport ring_report(const RingSettings& settings, const RingResult& result);

}  // namespace raya
