// Packets between nodes, as their traces are told of them.
#pragma once
#include <cstdint>
#include <functional>

#include "kernels/shared/packet.h"

namespace raya {

/// A packet that leaves the node where it was made or changed, on its way to another one.
struct PacketRecord {
    std::uint32_t superstep = 0, source = 0, destination = 0;  // nodes
    raya_head head{};
};
using PacketSink = std::function<void(const PacketRecord&)>;

}  // namespace raya
