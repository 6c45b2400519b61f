#include "host/study/rank_trials.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace raya {
namespace {

// The kernels that tell the loads must be those that are timed.
void check_device(const DeviceInfo& device, const RankedRender& render) {
    if (render.device != device.name)
        throw UserError(fmt::format(
            "study ranks runs on the default devices of its ranks, here {}, and was given {}: leave --device out, or "
            "name the device in RAYA_DEVICE",
            render.device, device.name));
}

}  // namespace

RanksHere look_around(const Mpirun& mpirun) {
    const std::uint32_t cores = own_place("").cores;
    RanksHere here{{1}, {1}, {}};
    for (std::uint32_t ranks = 2; ranks <= std::clamp(2 * cores, 4u, 16u); ranks *= 2) {
        const PingReport ping = ping_of(mpirun, ranks, 1);
        here.ranks.push_back(ranks);
        here.processors.push_back(cores_of(ping.ranks));
        const bool between_hosts = ping.ranks[ping.partner].host != ping.ranks[0].host;
        const bool known = ranks > 2 && here.ping.ranks[here.ping.partner].host != here.ping.ranks[0].host;
        if (ranks == 2 || (between_hosts && !known)) here.ping = ping;
    }
    return here;
}

std::vector<RankTrial> measure(const Mpirun& mpirun, const RankedMachine& machine, const RanksHere& here,
                               const DeviceInfo& device) {
    std::vector<RankTrial> trials(here.ranks.size());
    check_device(device, render_on_ranks(mpirun, 1, 1, machine.arguments));  // which builds the kernels
    for (int turn = 0; turn < kRankTurns; ++turn)
        for (std::size_t i = 0; i < trials.size(); ++i) {
            const std::vector<double>& seconds = trials[i].seconds;
            if (std::accumulate(seconds.begin(), seconds.end(), 0.0) >= kEnoughRankS) continue;
            RankedRender render = render_on_ranks(mpirun, here.ranks[i], 1, machine.arguments);
            const bool best = turn == 0 || render.render_s < trials[i].best.render_s;
            trials[i].seconds.push_back(render.render_s);
            if (best) trials[i].best = std::move(render);
        }
    return trials;
}

}  // namespace raya
