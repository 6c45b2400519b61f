// What messages between ranks take: a ping-pong over the transport that renders use, and the network of two numbers
// that lies nearest to it.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// Seconds that so many bytes take one way: the least of many times, since whatever else runs only adds to them.
struct MessageTime {
    std::uint64_t bytes = 0;
    double seconds = 0;
};

/// A message of b bytes takes alpha + beta b seconds (R. W. Hockney, Parallel Computing 20, 1994).
struct Network {
    double alpha_s = 0;
    double beta_s = 0;  // of a byte

    double seconds(double bytes) const { return alpha_s + beta_s * bytes; }
};

/// By least squares of the relative errors, so that short messages count as much as long ones; neither number below 0.
/// Two lengths at least, all times above 0.
Network fitted_network(std::span<const MessageTime> times);

/// Where a rank runs, and what of its host's processors its CPU device takes.
struct RankPlace {
    std::string host;
    std::uint32_t threads = 0;
    std::uint32_t cores = 0;  // of the host
};

/// Of this process.
RankPlace own_place(const std::string& host);

/// What a ping-pong has told.
struct PingReport {
    std::string library;
    std::vector<RankPlace> ranks;
    std::uint32_t partner = 0;          // who answered rank 0: the first rank of another host, or rank 1
    std::vector<MessageTime> messages;  // between the two
    std::vector<MessageTime> gathers;   // of all ranks, so many bytes each: what ends a superstep of the torus
    Network network;                    // fitted to the messages

    Json json() const;
};

/// Two ranks at least. Whole in rank 0 alone.
PingReport ping(Ranks& ranks);

}  // namespace raya
