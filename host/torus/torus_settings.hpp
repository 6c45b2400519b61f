// What a render on the torus machine is asked for.
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

/// Buffers of a node beside its words, in packets of 16 words (kernels/shared/packet.h).
struct NodeBuffers {
    std::uint32_t queue = 0;  // packets that wait in the node
    std::uint32_t box = 0;    // packets in one outbox or one inbox
};

/// Who makes the primary rays: the root, or every node those that enter the box at its voxels.
enum class Injection { kRoot, kAll };

/// Primary rays of the pixels first, first + stride, ... alone: a group of several that share the screen.
struct PixelSubset {
    std::uint32_t stride = 1, first = 0;
};

/// Nodes along x, y and z where nothing else is asked for (Yoshitani & Yamazaki).
inline constexpr std::array<std::uint32_t, 3> kUsualNodes = {4, 4, 4};

struct TorusSettings {
    Machine machine;
    std::uint32_t width = 0, height = 0;  // pixels
    raya_torus torus{};
    Links links = Links::kTorus3d;  // that `torus` was made with
    Divisions voxels{};
    Injection inject = Injection::kAll;
    PacketCharge packets;                       // what the model charges, whatever is moved
    std::uint32_t queue = 0;                    // packets that a node's queue holds; 0: what its memory leaves
    std::optional<std::uint64_t> memory_bytes;  // of a node; empty: no limit
    PixelSubset pixels;
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    KernelChoice kernels;
    std::uint32_t work_per_launch = 0;  // of a node, in a kernel's units; 0: as the device needs it (LaunchPlan)
    bool history = false;  // nodes tell what each packet cost them, which TorusRenderer::render() needs for a history
};

}  // namespace raya
