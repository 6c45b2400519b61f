// Part of a render report for the torus: nodes, packets, links and modelled time.
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
    std::string link_exchange;                       // how the device transfers packets: "copies" or "kernel"
    std::string link_origin;      // source of link_exchange: "options", "measured", "defaults" or "FILE, DATE"
    PacketCharge packets;         // modelled message sizes
    std::uint64_t returns = 0;    // number of returns that the model counts as messages
    std::uint64_t discarded = 0;  // number of primary rays that nodes generated and discarded
    std::uint64_t supersteps = 0;
    std::uint64_t live_max = 0;                             // maximum number of packets at a superstep's end
    std::array<std::uint64_t, RAYA_KINDS> made{}, ended{};  // [kind]: number of packets (kernels/shared/packet.h)
    std::uint64_t hops = 0;                                 // number of times that a message crossed a link

    struct {
        std::uint64_t count = 0;      // number of unidirectional links between different nodes
        std::uint64_t max_bytes = 0;  // bytes over the busiest link
        std::uint64_t total_bytes = 0;
        std::array<std::uint64_t, RAYA_LINKS> by_direction{};  // bytes over +x, -x, +y, -y, +z, -z links
        std::vector<std::uint64_t> sent;                       // [node]: number of bytes that the node sent
        double mean_bytes() const {
            return count > 0 ? static_cast<double>(total_bytes) / static_cast<double>(count) : 0;
        }
    } link;

    std::uint32_t queue = 0;      // capacity of a node's queue in packets
    std::uint32_t box = 0;        // capacity of an outbox or inbox in packets
    std::uint64_t queue_max = 0;  // maximum number of packets in a node's queue
    std::uint64_t copies = 0;     // number of additional copies of objects that are in several voxels
    TorusTime modelled;
};

/// Returns member "torus" of the render report.
Json torus_json(const TorusReport& report);

/// Returns member "modelled_ms" of the render report.
Json torus_time_json(const TorusTime& time);

/// Returns what one return packet contains: "rays" (the colour of a ray) or "terms" (one term of the colour).
const char* returns_name(const PacketCharge& packets);

/// Returns the numbers of operations of all counted events on T805s (host/model/t805.hpp).
Json t805_budget_json(const EventCounts& events, const PacketCharge& packets);

/// Returns nodes, links and voxels as text, for the summary's first line.
std::string torus_machine_text(const TorusReport& report);

/// Returns the summary's lines about packets, links and modelled time.
std::string torus_lines(const TorusReport& report);

/// Returns queues and copies as text, for the summary's line about memory.
std::string torus_memory_text(const TorusReport& report);

}  // namespace raya
