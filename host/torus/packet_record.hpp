// Packets between nodes, as their traces are told of them.
#pragma once
#include <cstdint>
#include <functional>

#include "kernels/shared/packet.h"

namespace raya {

/// A packet that leaves the node where it was made or changed, on its way to another one. A return that goes with
/// another one of its ray (TorusSettings::packets) is none.
struct PacketRecord {
    std::uint32_t superstep = 0, source = 0, destination = 0;  // nodes
    raya_head head{};
    std::uint32_t words = 0;  // that it is charged for on each link
};
using PacketSink = std::function<void(const PacketRecord&)>;

}  // namespace raya
