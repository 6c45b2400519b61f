// Torus members of a render report: nodes, packets, links and modelled time.
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
    std::string inject;                              // "root" or "all": nodes that generate primary rays
    std::string link_exchange;                       // how the device moves packets over links: "copies" or "kernel"
    std::string link_origin;                         // of that choice: "options", "measured", "defaults", "FILE, DATE"
    PacketCharge packets;                            // message sizes in the model
    std::uint64_t returns = 0;                       // sent as messages
    std::uint64_t discarded = 0;                     // primary rays that nodes generated and discarded
    std::uint64_t supersteps = 0;
    std::uint64_t live_max = 0;                             // maximum packets in the machine after a superstep
    std::array<std::uint64_t, RAYA_KINDS> made{}, ended{};  // packets of each kind (kernels/shared/packet.h)
    std::uint64_t hops = 0;                                 // messages over links

    struct {
        std::uint64_t count = 0;      // unidirectional links between different nodes
        std::uint64_t max_bytes = 0;  // over the busiest link
        std::uint64_t total_bytes = 0;
        std::array<std::uint64_t, RAYA_LINKS> by_direction{};  // +x, -x, +y, -y, +z, -z of the torus
        std::vector<std::uint64_t> sent;                       // bytes by each node
        double mean_bytes() const {
            return count > 0 ? static_cast<double>(total_bytes) / static_cast<double>(count) : 0;
        }
    } link;

    std::uint32_t queue = 0;      // capacity of a node's queue, packets
    std::uint32_t box = 0;        // capacity of each of its outboxes and inboxes, packets
    std::uint64_t queue_max = 0;  // maximum number of packets in a queue
    std::uint64_t copies = 0;     // of objects that lie in several voxels
    TorusTime modelled;
};

Json torus_json(const TorusReport& report);

Json torus_time_json(const TorusTime& time);

/// What a return carries: "rays" or "terms".
const char* returns_name(const PacketCharge& packets);

/// Operations of all events on a T805 (host/model/t805.hpp).
Json t805_budget_json(const EventCounts& events, const PacketCharge& packets);

/// Part of the summary's first line: nodes, links and voxels.
std::string torus_machine_text(const TorusReport& report);

/// Lines of the summary: packets, links, modelled time.
std::string torus_lines(const TorusReport& report);

/// Part of the summary's memory line: queues and copies.
std::string torus_memory_text(const TorusReport& report);

}  // namespace raya
