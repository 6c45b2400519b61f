// The networks by which study `ranks` predicts.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/ranks/ping.hpp"

namespace raya {

inline constexpr const char* kThisHost = "this host";

struct NamedNetwork {
    std::string name, source;
    Network network;

    double alpha_us() const { return 1e6 * network.alpha_s; }
    double beta_ns() const { return 1e9 * network.beta_s; }
};
using Networks = std::vector<NamedNetwork>;

/// That of the ping-pong, two that are assumed, and the user's where there is one.
Networks networks_of(const PingReport& ping, const std::optional<Network>& given);

}  // namespace raya
