// Message times between ranks, measured by a ping-pong over the same transport as a render's messages, and a linear
// network model that is fitted to the times.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// One-way time of a message: the minimum of many measurements, because other programs can only increase the time.
struct MessageTime {
    std::uint64_t bytes = 0;  // length of the message
    double seconds = 0;
};

/// A message of b bytes takes alpha + beta b seconds (R. W. Hockney, Parallel Computing 20, 1994).
struct Network {
    double alpha_s = 0;
    double beta_s = 0;  // seconds per byte

    double seconds(double bytes) const { return alpha_s + beta_s * bytes; }
};

/// Fits alpha and beta, both >= 0, by least squares of the relative errors of the times, so that short messages have as
/// much weight as long ones. Requires at least two different lengths and positive times.
Network fitted_network(std::span<const MessageTime> times);

/// Result of ping().
struct PingReport {
    std::string library;                // name and version of the MPI library
    std::uint32_t partner = 0;          // lowest rank that is not on rank 0's host; 1 if there is none
    std::vector<MessageTime> messages;  // times of messages between rank 0 and the partner
    Network network;                    // fitted to `messages`

    Json json() const;
};

/// Collective; requires at least two ranks. Only rank 0 gets the complete report.
PingReport ping(Ranks& ranks);

}  // namespace raya
