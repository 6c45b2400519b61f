// Settings of a render on the torus.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "host/accel/partition.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/model/machine.hpp"
#include "host/model/t805.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"

namespace raya {

/// Capacity of a node's buffers, in packets of 16 words (kernels/shared/packet.h).
struct NodeBuffers {
    std::uint32_t queue = 0;
    std::uint32_t box = 0;  // of one outbox or one inbox
};

/// Makers of primary rays: the root, or all nodes, each those that enter the bounding box at its voxels.
enum class Injection { kRoot, kAll };

/// The pixels first, first + stride, ...: the share of one of several groups of nodes.
struct PixelSubset {
    std::uint32_t stride = 1, first = 0;
};

/// Default number of nodes along x, y and z (Yoshitani & Yamazaki).
inline constexpr std::array<std::uint32_t, 3> kDefaultNodes = {4, 4, 4};

struct TorusSettings {
    Machine machine;
    std::uint32_t width = 0, height = 0;  // pixels
    raya_torus torus{};
    Links links = Links::kTorus3d;  // of `torus`
    Divisions voxels{};
    Injection inject = Injection::kAll;
    PacketCharge packets;                       // words that the model charges, which may differ from those moved
    std::uint32_t queue = 0;                    // packets of a node's queue; 0: as many as its memory allows
    std::optional<std::uint64_t> memory_bytes;  // of a node; empty: no limit
    PixelSubset pixels;
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    KernelChoice kernels;
    std::uint32_t work_per_launch = 0;  // of a node, in a kernel's units; 0: chosen for the device (LaunchPlan)
    bool history = false;               // nodes record the cost of each packet, as RenderObservers::work needs it
};

}  // namespace raya
