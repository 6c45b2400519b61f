// Settings of a render on the torus.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "host/accel/partition.hpp"
#include "host/array/render.hpp"
#include "host/model/t805.hpp"
#include "host/torus/topology.hpp"

namespace raya {

/// Capacities of a node's buffers, in packets.
struct NodeBuffers {
    std::uint32_t queue = 0;  // capacity of the queue
    std::uint32_t box = 0;    // capacity of each outbox and each inbox
};

/// Nodes that generate primary rays. kRoot: the root generates all primary rays. kAll: each node generates the primary
/// rays that enter the bounding box at one of the node's voxels.
enum class Injection { kRoot, kAll };

/// The pixels with row-major indices first, first + stride, first + 2 stride, ... A machine of several groups of nodes
/// renders one such subset of the pixels on each group.
struct PixelSubset {
    std::uint32_t stride = 1, first = 0;
};

/// Default number of nodes along x, y and z (Yoshitani & Yamazaki).
inline constexpr std::array<std::uint32_t, 3> kDefaultNodes = {4, 4, 4};

struct TorusSettings : RenderSettings {
    std::uint32_t width = 0, height = 0;  // pixels
    raya_torus torus{};
    Links links = Links::kTorus3d;  // topology of `torus`
    Divisions voxels{};             // numbers of voxels along x, y, z
    Injection inject = Injection::kAll;
    PacketCharge packets;                       // modelled sizes of packets; the device may move more or fewer words
    std::uint32_t queue = 0;                    // capacity of a node's queue, packets; 0: plan_buffers() chooses
    std::optional<std::uint64_t> memory_bytes;  // memory of a node; empty: no limit
    PixelSubset pixels;
    bool history = false;  // record the cost of each packet; required by RenderObservers::work
};

}  // namespace raya
