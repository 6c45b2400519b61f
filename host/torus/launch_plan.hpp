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

/// Maximum work of a node in one launch, in units that the kernel defines. The host repeats the launch until no node
/// has work left.
struct LaunchBudget {
    std::uint32_t work = 0;
    bool single_launch = false;  // one launch is certainly enough, so the host need not read the status

    bool operator==(const LaunchBudget&) const = default;
};

/// Limits a launch to about a second, so that Ctrl-C takes effect and the GPU's watchdog does not end it, and to the
/// maximum number of loop iterations of the device. Stores each node's number of objects and an upper bound of its
/// packets, to determine LaunchBudget::single_launch.
class LaunchPlan {
  public:
    /// `memories`: memories of this rank's nodes, by slots of `share`.
    LaunchPlan(const TorusSettings& settings, const NodeMemories& memories, const NodeShare& share,
               const NodeBuffers& buffers, const KernelOptions& options, const DeviceInfo& device);

    /// Resets the upper bounds of packets to 0.
    void clear();

    /// Updates the upper bounds of packets from `status`, which was read after routing or before tracing. Until the
    /// next update, a node has at most the packets that are now in its queue and in the mailboxes of links that end at
    /// the node.
    void update(const NodeStatus& status);

    /// Budgets of the next launches. inject() also raises the upper bounds to the number of packets up to which
    /// inject.cl fills a queue.
    LaunchBudget inject();
    LaunchBudget trace_voxel() const;
    LaunchBudget route() const;
    LaunchBudget accept() const;

  private:
    struct Node {
        std::uint64_t voxels = 0;
        std::uint64_t max_objects = 0;  // maximum number of objects in one of its voxels
        std::uint64_t inject_work = 0;  // units of work of inject in an image: rows, and batches of their pixels
        std::uint64_t packets = 0;      // upper bound of the packets in its queue
    };
    /// A kernel's unit of work.
    struct WorkUnit {
        double iterations;    // maximum loop iterations of a unit
        double per_test = 1;  // number of units that take as long as a ray-object test
        double overrun = 0;   // units by which a launch may exceed its budget to complete work that it has begun
    };
    /// Returns the budget of a launch. `max_work`, `total_work`: upper bounds of the work of one node, and of all nodes
    /// together.
    LaunchBudget budget(const WorkUnit& unit, std::uint64_t max_work, std::uint64_t total_work) const;
    std::uint64_t trace_work(const Node& node, std::uint64_t packets) const;

    const NodeShare& share_;
    const NodeBuffers buffers_;
    std::uint32_t lanes_, group_size_, lights_ = 0, max_corners_ = 0;  // max_corners_: maximum of a polygon
    std::uint32_t max_loop_iterations_, work_per_launch_;
    bool exact_;               // the device rounds quotients and square roots correctly: no refinement loops
    std::vector<Node> nodes_;  // [slot]
};

}  // namespace raya
