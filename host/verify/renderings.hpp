// Renderings of the reference images: the settings with which layer "image" renders them.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/machine.hpp"
#include "host/ring/mapping.hpp"
#include "host/torus/torus_settings.hpp"
#include "host/verify/reference_images.hpp"
#include "host/verify/verify.hpp"

namespace raya {

/// A reference image and the settings that must not change any bit of it.
struct Rendering {
    std::string image;
    Depth min_depth = Depth::kFull;           // verify() includes the rendering at this and greater depths
    std::uint32_t lanes = 0, group_size = 0;  // 0: the device's default
    MappingRule mapping = cyclic_mapping(8);  // mapping of pixels to PEs of the ring
    std::uint32_t pes = kReferenceSide;
    std::uint32_t work_per_launch = 0;  // see RingSettings and TorusSettings; 0: default
    AccelKind accel = AccelKind::kNone;
    bool packets = false;  // ring: RingSettings::packets
    bool torus = false;
    std::array<std::uint32_t, 3> nodes = {2, 2, 2};
    // More voxels than nodes, so that some nodes have several.
    std::array<std::uint32_t, 3> voxels = {nodes[0] + 1, nodes[1] + 2, nodes[2]};
    Links links = Links::kTorus3d;
    Injection inject = Injection::kAll;
    std::uint32_t queue = 0;     // capacity of the queues of the torus, packets; 0: default
    std::uint32_t pe_bytes = 0;  // memory of a PE of the ring; 0: no limit
    bool history = false;        // record the cycles of each packet and check their sum in each node
    bool global_words = false;   // job words are in global memory, as if local memory were too small
    bool fallback_code = false;  // as if the device did not round division, square root and fma correctly, and the
                                 // compiler had none of the builtins that raya uses

    /// Returns the name of the renderer with its accelerator or torus, such as "ring", "bvh" or "torus2d 3x2x2 root".
    /// It is the key in StoredImage::counts: renderings of an image by the same renderer have equal counts.
    std::string check_kind() const;

    std::string name() const;
};

/// Returns renderings that together use every kernel and option. Building kernels takes most of a rendering's time, so
/// renderings with equal build options are adjacent and use the same build. For the same reason some renderings of
/// depth kQuick combine several features, such as global words and fallback code. The renderings of depth kBrief need
/// three builds: one for each machine and one for a reduced format.
std::vector<Rendering> standard_renderings();

/// Returns renderings with every number of lanes and groups of 1 and 32 work-items, on both machines, in fp32 and
/// reduced formats.
std::vector<Rendering> renderings_of_all_builds();

}  // namespace raya
