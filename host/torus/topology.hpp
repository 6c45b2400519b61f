// The torus machine's nodes and links (kernels/shared/torus.h).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/array/render.hpp"
#include "host/model/t805.hpp"
#include "kernels/shared/torus.h"
#include "kernels/shared/traffic.h"

namespace raya {

inline constexpr std::uint32_t kMaxNodes = 65536;  // maximum number of nodes

/// Topology of the links.
enum class Links { kTorus3d, kTorus2d };

/// Returns "torus3d" or "torus2d".
std::string links_name(Links links);

/// Makes a torus of I x J x K nodes. A 2-D torus arranges the K slabs of I x J nodes in rows of C slabs, so that its
/// sides are I C and J K / C nodes. C is the divisor of K that minimises the difference of the sides; in case of a tie,
/// the smallest such divisor. Throws UserError unless I, J, K >= 1 and I J K <= kMaxNodes.
raya_torus make_torus(const std::array<std::uint32_t, 3>& nodes, Links links);

/// Returns the number of links of a node that lead to another node: 2 for each side of the torus that is longer than 1,
/// so at most 6 in a 3-D torus and 4 in a 2-D torus.
std::uint32_t links_of_node(const raya_torus& torus);

/// Returns the node to which `sender` sends a packet: the root for a return, `sender` for a ray that misses the box,
/// else the node that holds the packet's voxel.
std::uint32_t destination_of(const raya_torus& torus, std::uint32_t sender, const raya_head& packet);

/// Returns text such as "4x4x4".
std::string sides_text(const std::array<std::uint32_t, 3>& sides);

// Distribution of the torus nodes over ranks, and the status words of nodes.

/// Returns [node]: rank of the node, 0..ranks - 1; rank 0 has the root. Each rank gets a cuboid of nodes. Recursive
/// bisection cuts each cuboid across its longest side, between two layers of nodes, and gives half of the ranks to each
/// part. Throws UserError for more ranks than nodes.
std::vector<std::uint32_t> ranks_of_nodes(const raya_torus& torus, std::uint32_t ranks);

/// Distribution of the nodes over the ranks.
class NodeDistribution : public Distribution {
  public:
    explicit NodeDistribution(const raya_torus& torus, Ranks& ranks = Ranks::single());

    const raya_torus& torus() const { return torus_; }

    /// Number of inboxes that this rank has for each link direction. The first inboxes belong to links that start at
    /// nodes of this rank, and are indexed by the slot of the start. Inboxes of links from other ranks follow. All
    /// directions have the same number of inboxes: the maximum that a direction needs.
    std::uint32_t inboxes() const { return inboxes_; }

    /// Returns the index of the inbox for packets that `sender` sends over its link `link`. The sender or the node at
    /// the end of the link must be in this rank.
    std::uint32_t inbox_from(std::uint32_t sender, std::uint32_t link) const;

  private:
    raya_torus torus_;
    std::uint32_t inboxes_ = 0;
    // [link]: nodes of other ranks whose link in that direction ends in this rank, ascending
    std::vector<std::vector<std::uint32_t>> remote_senders_;
};

/// Host copy of the nodes' status words: [node][RAYA_STATUS_WORDS].
struct NodeStatus {
    std::uint32_t at(std::uint32_t node, std::uint32_t word) const {
        return words[std::size_t{node} * RAYA_STATUS_WORDS + word];
    }
    std::vector<std::uint32_t> words;
};

// Settings of a render on the torus.

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
