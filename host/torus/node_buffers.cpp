#include "host/torus/node_buffers.hpp"

#include <algorithm>

#include "kernels/shared/packet.h"

namespace raya {

NodeBuffers buffers_for(std::uint32_t queue) { return {queue, std::max(1u, queue / 4)}; }

std::uint32_t default_queue(std::uint32_t nodes) { return std::min(8192u, (1u << 24) / nodes); }

std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links) {
    constexpr std::uint64_t kRayBytes = RAYA_PACKET_WORDS * sizeof(std::uint32_t);
    constexpr std::uint64_t kReturnBytes = RAYA_RETURN_WORDS * sizeof(std::uint32_t);
    const std::uint64_t return_boxes = links > 0 ? links + 1 : 0;
    return sizeof(std::uint32_t) * words + kRayBytes * (buffers.queue + std::uint64_t{2} * links * buffers.box) +
           kReturnBytes * return_boxes * buffers.box;
}

}  // namespace raya
