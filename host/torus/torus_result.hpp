// What a render on the torus machine made, counted and measured.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/image/image.hpp"
#include "host/model/load.hpp"
#include "host/model/machine.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/length_scale.hpp"
#include "host/torus/node_buffers.hpp"
#include "host/torus/superstep.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Packets of each kind (RAYA_KIND_* of kernels/shared/packet.h).
using PacketCounts = std::array<std::uint64_t, RAYA_KINDS>;

struct TorusResult {
    Image image;  // pixels outside the subset are 0
    EventCounts events{};
    Load load;  // modelled cycles of each node
    std::vector<Superstep> supersteps;
    PacketCounts made{}, ended{};
    std::uint64_t returns = 0;                        // that are messages of their own (TorusSettings::packets)
    std::uint64_t hops = 0;                           // messages over links
    std::vector<std::uint64_t> link_words;            // [node][RAYA_LINKS]: charged for over each link
    std::vector<std::uint64_t> link_packets;          // [node][RAYA_LINKS]: messages
    std::uint64_t moved_rays = 0, moved_returns = 0;  // packets over links, as the device moved them
    std::uint64_t queue_max = 0;                      // most packets that any node's queue held
    std::uint64_t copies = 0;                         // of objects in several voxels
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t node_bytes = 0;    // of the fullest node: words and buffers
    std::uint64_t copied_words = 0;  // of the scene, by all nodes into local memory, whenever a kernel starts
    bool links_by_kernel = false;    // packets came over the device's links by a kernel, else by copies
    std::string links_origin;  // who chose: "options", the file and date of what was tuned, "measured", "defaults"
    std::uint64_t contributions = 0;  // return packets that reached the host
    std::uint32_t parts_here = 0;     // nodes of this rank
    RankTraffic traffic;              // of this rank, while it rendered
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;                 // where lanes, group and what goes with them come from (host/cl/tuned.hpp)
    double build_s = 0, render_s = 0;  // measured on the host: kernel build; everything after it
    std::vector<LabelSummary> commands;
};

}  // namespace raya
