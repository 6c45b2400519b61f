#include "host/kernels/operation_rates.hpp"

#include <algorithm>

#include "host/kernels/kernels.hpp"
#include "kernels/shared/chains.h"

namespace raya {
namespace {

using OperationsKernel =
    DescribedKernel<"number/operations.cl", "operations", Uint<"kind">, Uint<"rounds">, cl_float, Buffer<float>&>;

double last_seconds(Session& session) {
    const double ns = static_cast<double>(session.profile().summary().back().total_ns);
    session.clear_profile();
    return ns * 1e-9;
}

}  // namespace

std::array<double, kOperations.size()> operation_rates(Session& session, const NumberFormat& format,
                                                       std::uint32_t lanes, int samples) {
    const std::uint32_t group_size = default_group_size(session.device());
    Kernels kernels(session, {.lanes = lanes, .group_size = group_size, .format = format});
    auto kernel = kernels.get<OperationsKernel>();
    // A few items a unit on a CPU; enough to hide latencies elsewhere.
    const std::size_t items = std::size_t{session.device().compute_units} * (session.device().type == "cpu" ? 2 : 2048);
    Buffer<float> results = session.buffer<float>("results of operations", items * lanes);
    std::array<double, kOperations.size()> rates{};
    for (std::uint32_t kind = 0; kind < rates.size(); ++kind) {
        cl_uint rounds = 1000;
        const auto seconds = [&] {
            session.clear_profile();
            session.launch("operations", kernel, items / group_size, group_size, Uint<"kind">{kind},
                           Uint<"rounds">{rounds}, 1.0f, results);
            return last_seconds(session);
        };
        seconds();  // PoCL compiles here
        while (seconds() < 0.01 && rounds < 100'000'000) rounds *= 4;
        double best = 0;
        for (int i = 0; i < samples; ++i) {
            const double once = seconds();
            if (once > 0) best = std::max(best, static_cast<double>(items) * lanes * RAYA_CHAINS * rounds / once);
        }
        rates[kind] = best;
    }
    return rates;
}

}  // namespace raya
