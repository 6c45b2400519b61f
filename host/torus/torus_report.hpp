// The torus's part of a render report.
#pragma once
#include "host/report/render_report.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// Returns nodes, packets, links, operations and modelled time. `asynchronous`: the time of the machine without
/// supersteps, if it was simulated.
MachineReport torus_report(const TorusSettings& settings, const TorusResult& result,
                           const std::optional<AsynchronousTime>& asynchronous);

/// Returns the numbers of operations of all counted events on T805s (host/model/t805.hpp).
Json t805_budget_json(const EventCounts& events, const PacketCharge& packets);

}  // namespace raya
