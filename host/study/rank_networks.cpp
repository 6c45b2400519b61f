#include "host/study/rank_networks.hpp"

#include <fmt/core.h>

namespace raya {

Networks networks_of(const PingReport& ping, const std::optional<Network>& given) {
    Networks networks = {{kThisHost, fmt::format("fitted to the ping-pong, {}", ping.library), ping.network},
                         {"10 GbE", "assumed: 10 Gbit/s of IEEE 802.3ae; 30 us, about what TCP takes", {30e-6, 0.8e-9}},
                         {"InfiniBand HDR",
                          "assumed: 200 Gbit/s of a 4x port; 1 us, an adapter's 0.6 us and what MPI adds",
                          {1e-6, 0.04e-9}}};
    if (given) networks.push_back({"given", "given with --network", *given});
    return networks;
}

}  // namespace raya
