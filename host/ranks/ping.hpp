// Message times between ranks: a ping-pong over the transport of renders, and a linear network model fitted to it.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// One-way time of a message: the minimum of many, as other load can only add to it.
struct MessageTime {
    std::uint64_t bytes = 0;
    double seconds = 0;
};

/// A message of b bytes takes alpha + beta b seconds (R. W. Hockney, Parallel Computing 20, 1994).
struct Network {
    double alpha_s = 0;
    double beta_s = 0;  // per byte

    double seconds(double bytes) const { return alpha_s + beta_s * bytes; }
};

/// Least-squares fit of the relative errors, so that short messages weigh as much as long ones; both parameters >= 0.
/// Requires at least two different lengths and positive times.
Network fitted_network(std::span<const MessageTime> times);

/// Host of a rank, and its share of the processors.
struct RankPlace {
    std::string host;
    std::uint32_t threads = 0;  // of its CPU device
    std::uint32_t cores = 0;    // of the host
};

/// Of this process.
RankPlace own_place(const std::string& host);

/// Result of ping().
struct PingReport {
    std::string library;
    std::vector<RankPlace> ranks;
    std::uint32_t partner = 0;          // of rank 0: the first rank of another host, or rank 1
    std::vector<MessageTime> messages;  // between rank 0 and the partner
    std::vector<MessageTime> gathers;   // all-gather of `bytes` of each rank, as at the end of a torus superstep
    Network network;                    // fitted to the messages

    Json json() const;
};

/// Collective; requires at least two ranks. Only rank 0 gets the complete report.
PingReport ping(Ranks& ranks);

}  // namespace raya
