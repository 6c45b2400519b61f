// Makes the history of a render out of what its nodes did in each superstep.
#pragma once
#include <cstdint>
#include <vector>

#include "host/model/t805.hpp"
#include "host/torus/history.hpp"
#include "host/torus/node_work.hpp"
#include "host/torus/ray_numbers.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Takes the work of all nodes, superstep by superstep, as a NodeWorkSink is given it. Keeps 24 bytes for each ray in
/// each voxel and 12 for each packet, and the numbers of the rays.
class HistoryRecorder {
  public:
    /// `packets`: what messages are charged for. Returns that go with another one for nothing are in no history.
    explicit HistoryRecorder(const raya_torus& torus, const PacketCharge& packets = {})
        : torus_(torus), packets_(packets), in_vain_(raya_nodes(torus)) {}

    /// std::logic_error for a packet that nobody sent, or more of them than numbers of 32 bits.
    void add(const NodeWork& work);

    /// The whole history, checked; the last that may be asked of the recorder. Its tasks' cycles are those of the
    /// render: of a node those of its packets and of its injection. What rays that were made in vain cost is part of
    /// the next one's that the node kept, behind the last one a task of its own.
    History finish();

  private:
    struct Sent {
        HistoryMessage message;
        std::uint64_t ray = 0;  // number of the ray that it is or, of a return, comes from
    };
    struct Ray {
        std::uint32_t message = UINT32_MAX;  // its last one
        std::uint32_t task = UINT32_MAX;     // its last treatment
    };
    Ray& ray_of(std::uint64_t number);
    void add_injection(const NodeWork& work);
    void add_treated(const NodeWork& work);
    void add_packets(const NodeWork& work, std::size_t first_task);
    std::uint32_t goal_of(std::uint32_t node, const raya_head& packet) const;
    std::uint16_t words_of(std::uint32_t kind) const;
    void send(const Sent& sent);

    raya_torus torus_;
    PacketCharge packets_;
    History history_;
    RayNumbers numbers_;
    std::vector<Ray> rays_;               // [number]
    std::vector<std::uint64_t> in_vain_;  // [node]: cycles of injection that no ray has been charged with
};

}  // namespace raya
