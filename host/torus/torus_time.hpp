// Modelled time of a render on a torus of T805s, from what was counted: two bounds, and what makes them.
#pragma once
#include "host/model/time_model.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// The times of a render on `torus`, by machine/t805.hpp:
///   - overlapped: the busiest processor, which computes and has its part in every message that passes over one of its
///     links, or the busiest link, whichever takes longer. Nothing on that machine can be faster.
///   - stepwise: the sum over supersteps of what the busiest node computes and the busiest link carries, at the rate
///   that
///     is left to each way when both are busy. The processors' part of messages is hidden behind that: at most
///     12 ways x (2 + 19 / 8) cycles for a word of the busiest way, which takes 83 cycles on its link.
/// So overlapped <= stepwise. std::invalid_argument where `result` is not that torus's.
TorusTime torus_time(const raya_torus& torus, const TorusResult& result);

}  // namespace raya
