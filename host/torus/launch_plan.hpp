// Work budgets of kernel launches: the maximum work of a node in one launch, and whether a single launch suffices.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// In one launch a kernel does at most `work` units of work for each node. The host repeats the launch until no node
/// has work left. `once`: one launch is certainly enough, so the host need not read the status to find out.
struct LaunchBudget {
    std::uint32_t work = 0;
    bool once = false;

    bool operator==(const LaunchBudget&) const = default;
};

/// Limits a launch to about a second, so that Ctrl-C takes effect and the GPU's watchdog does not end it, and to the
/// maximum number of loop iterations of the device. Keeps the number of objects and an upper bound of the packets of
/// each node, to determine LaunchBudget::once.
class LaunchPlan {
  public:
    /// `memories`: memories of this rank's nodes, by slots of `share`.
    LaunchPlan(const TorusSettings& settings, const NodeMemories& memories, const NodeShare& share,
               const NodeBuffers& buffers, const KernelOptions& options, const DeviceInfo& device);

    /// Resets the upper bounds of packets to 0.
    void clear();

    /// Updates the upper bounds of packets from `status`, which was read after routing or before tracing. Until the
    /// next update a node's queue can receive at most the packets now in it and in the mailboxes of links that lead to
    /// the node.
    void look(const NodeStatus& status);

    /// Budgets of the next launches. inject() also raises the upper bounds to the number of packets up to which
    /// inject.cl fills a queue.
    LaunchBudget inject();
    LaunchBudget trace_voxel() const;
    LaunchBudget route() const;
    LaunchBudget accept() const;

  private:
    struct Node {
        std::uint64_t voxels = 0;
        std::uint64_t most = 0;         // maximum number of objects in one of its voxels
        std::uint64_t inject_work = 0;  // units of work of inject in an image: rows, and batches of their pixels
        std::uint64_t packets = 0;      // upper bound of the packets in its queue
    };
    /// A kernel's unit of work. turns: maximum loop iterations of a unit; of_test: number of units that take as long as
    /// a ray-object test; beyond: units by which a launch may exceed its budget to complete the work that it has begun.
    struct Unit {
        double turns, of_test = 1, beyond = 0;
    };
    /// Returns the budget of a launch. `most`, `all`: upper bounds of the work of one node, and of all nodes together.
    LaunchBudget budget(const Unit& unit, std::uint64_t most, std::uint64_t all) const;
    std::uint64_t trace_work(const Node& node, std::uint64_t packets) const;

    const NodeShare& share_;
    const NodeBuffers buffers_;
    std::uint32_t lanes_, group_, lights_ = 0, corners_ = 0;  // corners_: maximum of a polygon
    std::uint32_t loop_turns_, work_per_launch_;
    bool exact_;               // the device rounds quotients and square roots correctly: no refinement loops
    std::vector<Node> nodes_;  // [slot]
};

}  // namespace raya
