// Message times between ranks, measured by a ping-pong over the transport that renders use, and a linear network model
// that is fitted to them.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// One-way time of a message. The minimum of many measurements, as other load can only increase the time.
struct MessageTime {
    std::uint64_t bytes = 0;
    double seconds = 0;
};

/// A message of b bytes takes alpha + beta b seconds (R. W. Hockney, Parallel Computing 20, 1994).
struct Network {
    double alpha_s = 0;
    double beta_s = 0;  // seconds per byte

    double seconds(double bytes) const { return alpha_s + beta_s * bytes; }
};

/// Fits alpha and beta, both >= 0, by least squares of the relative errors, so that short messages have as much weight
/// as long ones. Requires at least two different lengths and positive times.
Network fitted_network(std::span<const MessageTime> times);

/// Host of a rank, and the processors that the rank uses.
struct RankPlace {
    std::string host;
    std::uint32_t threads = 0;  // number of threads of its CPU device
    std::uint32_t cores = 0;    // number of cores of the host
};

/// Returns the place of this process; `host`: the host's name.
RankPlace own_place(const std::string& host);

/// Result of ping().
struct PingReport {
    std::string library;
    std::vector<RankPlace> ranks;
    std::uint32_t partner = 0;          // rank that rank 0 exchanges messages with: the first on another host, or 1
    std::vector<MessageTime> messages;  // messages between rank 0 and the partner
    std::vector<MessageTime> gathers;   // all-gather, `bytes` per rank, as at the end of a torus superstep
    Network network;                    // fitted to the messages

    Json json() const;
};

/// Collective; requires at least two ranks. Only rank 0 gets the complete report.
PingReport ping(Ranks& ranks);

}  // namespace raya
