#include "host/cl/operation_rates.hpp"

#include <algorithm>

#include "kernels/shared/chains.h"

namespace raya {
namespace {

// A few groups a unit on a CPU; enough to hide latencies elsewhere.
std::size_t work_items(const DeviceInfo& device, std::uint32_t group) {
    return std::size_t{device.compute_units} * (device.type == "cpu" ? 2 * group : 2048);
}

}  // namespace

OperationRates::OperationRates(Session& session, const NumberFormat& format, std::uint32_t lanes)
    : session_(session),
      group_size_(default_group_size(session.device())),
      items_(work_items(session.device(), group_size_)),
      lanes_(lanes),
      kernels_(session, {.lanes = lanes, .group_size = group_size_, .format = format}),
      chains_(kernels_.get<Chains>()),
      results_(session.buffer<float>("results of operations", items_ * lanes)) {}

double OperationRates::seconds(std::size_t kind) {
    session_.clear_profile();
    session_.launch("operations", chains_, items_ / group_size_, group_size_, Uint<"kind">{static_cast<cl_uint>(kind)},
                    Uint<"rounds">{rounds_[kind]}, 1.0f, results_);
    const double ns = static_cast<double>(session_.profile().summary().back().total_ns);
    session_.clear_profile();
    return ns * 1e-9;
}

void OperationRates::find_rounds(std::size_t kind) {
    rounds_[kind] = 1000;
    seconds(kind);  // PoCL compiles here
    while (seconds(kind) < 0.01 && rounds_[kind] < 100'000'000) rounds_[kind] *= 4;
}

double OperationRates::measure(std::size_t kind, int samples) {
    if (rounds_[kind] == 0) find_rounds(kind);
    const double operations = static_cast<double>(items_ * lanes_) * RAYA_CHAINS * rounds_[kind];
    double best = 0;
    for (int i = 0; i < samples; ++i) {
        const double once = seconds(kind);
        if (once > 0) best = std::max(best, operations / once);
    }
    return best;
}

}  // namespace raya
