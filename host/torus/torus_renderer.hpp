// Renders a scene on a model of a torus machine: nodes hold voxels of the scene, rays travel between them as packets.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/files/progress.hpp"
#include "host/grid/partition.hpp"
#include "host/image/image.hpp"
#include "host/kernels/kernel_options.hpp"
#include "host/machine/load.hpp"
#include "host/machine/machine.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Who makes the primary rays: the root, or every node those that enter the box at its voxels.
enum class Injection { kRoot, kAll };

/// Primary rays of the pixels first, first + stride, ... alone: a group of several that share the screen.
struct PixelSubset {
    std::uint32_t stride = 1, first = 0;
};

struct TorusSettings {
    Machine machine;
    std::uint32_t width = 0, height = 0;  // pixels
    raya_torus torus{};
    Links links = Links::kTorus3d;  // that `torus` was made with
    Divisions voxels{};
    Injection inject = Injection::kAll;
    std::uint32_t queue = 0;                    // packets that a node's queue holds; 0: what its memory leaves
    std::optional<std::uint64_t> memory_bytes;  // of a node; empty: no limit
    PixelSubset pixels;
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    KernelChoice kernels;
};

/// Packets of each kind (RAYA_KIND_* of kernels/shared/packet.h).
using PacketCounts = std::array<std::uint64_t, RAYA_KINDS>;

/// What was counted in one superstep, for time models and traces.
struct Superstep {
    std::uint64_t most_cycles = 0;      // computing, of the busiest node
    std::uint64_t most_link_words = 0;  // over one link in one direction, the busiest
    std::uint64_t live = 0;             // packets in queues and boxes at its end
};

/// A packet that leaves the node where it was made or changed, on its way to another one.
struct PacketRecord {
    std::uint32_t superstep = 0, source = 0, destination = 0;  // nodes
    raya_head head{};
};
using PacketSink = std::function<void(const PacketRecord&)>;

/// What every node did in one superstep.
struct SuperstepDetail {
    const Superstep& all;
    std::vector<std::uint64_t> cycles;             // [node]: computing
    const std::vector<std::uint64_t>& link_words;  // [node][RAYA_LINKS]: sent over each link
};
using SuperstepSink = std::function<void(const SuperstepDetail&)>;

struct TorusResult {
    Image image;  // pixels outside the subset are 0
    EventCounts events{};
    Load load;  // modelled cycles of each node
    std::vector<Superstep> supersteps;
    PacketCounts made{}, ended{};
    std::uint64_t hops = 0;                   // packets over links
    std::vector<std::uint64_t> link_words;    // [node][RAYA_LINKS]: words sent over each link
    std::vector<std::uint64_t> link_packets;  // [node][RAYA_LINKS]
    std::uint64_t queue_max = 0;              // most packets that any node's queue held
    std::uint64_t copies = 0;                 // of objects in several voxels
    NodeBuffers buffers;
    std::uint64_t node_bytes = 0;     // of the fullest node: words and buffers
    std::uint64_t copied_words = 0;   // of the scene, by all nodes into local memory, whenever a kernel starts
    std::uint64_t contributions = 0;  // return packets that reached the host
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    double build_s = 0, render_s = 0;  // measured on the host: kernel build; everything after it
    std::vector<LabelSummary> commands;
};

class TorusRenderer {
  public:
    /// Partitions and packs the scene, checks that it fits the nodes, builds the kernels and takes the device memory.
    /// Throws UserError (what does not fit, what is out of range), DeviceError.
    TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings);
    ~TorusRenderer();

    /// One image; may be called again. `sink`, where given, is told of every packet between nodes, in the order of
    /// supersteps, then sources, or of those of supersteps 0, `packets_every`, ... alone, since telling takes time;
    /// `step_sink` of every superstep. UserError where the machine stands still, with a queue
    /// that is long enough.
    TorusResult render(const ProgressCallback& progress = {}, const PacketSink& sink = {},
                       const SuperstepSink& step_sink = {}, std::uint32_t packets_every = 1);

    /// Other pixels for the images that follow: groups of a machine render in turn without building anew.
    void set_pixels(const PixelSubset& pixels);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace raya
