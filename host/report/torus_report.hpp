// What a torus machine reports beside what every machine does: nodes, packets, links and their modelled time.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/model/machine.hpp"
#include "host/model/t805.hpp"
#include "host/model/time_model.hpp"
#include "kernels/shared/packet.h"
#include "kernels/shared/torus.h"

namespace raya {

struct TorusReport {
    std::array<std::uint32_t, 3> nodes{}, voxels{};  // along x, y and z
    std::string links;                               // "torus3d" or "torus2d"
    std::string inject;                              // "root" or "all": who makes the primary rays
    std::string link_exchange;                       // "copies" or "kernel": how packets came over the device's links
    std::string link_origin;                         // "options", "measured", "defaults", or what was tuned: who chose
    PacketCharge packets;                            // what the model charges
    std::uint64_t returns = 0;                       // that are messages
    std::uint64_t discarded = 0;                     // primary rays that nodes made and threw away
    std::uint64_t supersteps = 0;
    std::uint64_t live_max = 0;                             // most packets in all queues and boxes at a superstep's end
    std::array<std::uint64_t, RAYA_KINDS> made{}, ended{};  // packets of each kind (kernels/shared/packet.h)
    std::uint64_t hops = 0;                                 // messages over links

    struct {
        std::uint64_t count = 0;      // that lead to another node, of all nodes; each is one way
        std::uint64_t max_bytes = 0;  // over the busiest of them
        std::uint64_t total_bytes = 0;
        std::array<std::uint64_t, RAYA_LINKS> by_direction{};  // +x, -x, +y, ... of the torus, of all nodes
        std::vector<std::uint64_t> sent;                       // bytes by each node
        double mean_bytes() const {
            return count > 0 ? static_cast<double>(total_bytes) / static_cast<double>(count) : 0;
        }
    } link;

    std::uint32_t queue = 0;      // packets that a node's queue holds
    std::uint32_t box = 0;        // packets that each of its outboxes and inboxes holds
    std::uint64_t queue_max = 0;  // most packets that waited in a queue
    std::uint64_t copies = 0;     // of objects in several voxels
    TorusTime modelled;
};

Json torus_json(const TorusReport& report);

Json torus_time_json(const TorusTime& time);

/// "rays" or "terms": of what returns are made.
const char* returns_name(const PacketCharge& packets);

/// Operations of all that was counted, as a T805 does them (machine/t805.hpp).
Json t805_budget_json(const EventCounts& events, const PacketCharge& packets);

/// For the summary's first line: nodes, links and voxels.
std::string torus_machine_text(const TorusReport& report);

/// The summary's lines about packets, links and modelled time.
std::string torus_lines(const TorusReport& report);

/// For the summary's line about memory: queues and copies.
std::string torus_memory_text(const TorusReport& report);

}  // namespace raya
