// Work budgets of kernel launches: how much a node may do in one launch, and whether a single launch suffices.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// A launch of a node kernel ends after `work` units of the kernel in a node, and is repeated until no work is left.
/// `once`: a single launch is certain to be enough, so the host need not read back whether work is left.
struct LaunchBudget {
    std::uint32_t work = 0;
    bool once = false;

    bool operator==(const LaunchBudget&) const = default;
};

/// Limits launches to about a second, so that Ctrl-C takes effect and no GPU watchdog intervenes, and to the loop
/// iterations that a device allows. Tracks the objects of each node and an upper bound of its packets, so that the host
/// can skip reading back whether work is left.
class LaunchPlan {
  public:
    /// `memories`: of the nodes of `share`, in the order of its slots.
    LaunchPlan(const TorusSettings& settings, const NodeMemories& memories, const NodeShare& share,
               const NodeBuffers& buffers, const KernelOptions& options, const DeviceInfo& device);

    /// Resets to empty queues and mailboxes.
    void clear();

    /// Updates the bounds from the nodes' status, read after routing or before tracing. A node's queue may receive
    /// everything that waits in it and in the mailboxes of links that lead to it before the next update.
    void look(const NodeStatus& status);

    /// Budgets of the next launches. inject() raises the bounds by the rays that it may make.
    LaunchBudget inject();
    LaunchBudget trace_voxel() const;
    LaunchBudget route() const;
    LaunchBudget accept() const;

  private:
    struct Node {
        std::uint64_t voxels = 0;
        std::uint64_t most = 0;         // maximum number of objects in a voxel
        std::uint64_t inject_work = 0;  // inject's units of work for an image: rows, and batches of their pixels
        std::uint64_t packets = 0;      // upper bound of its queue's length
    };
    /// A kernel's unit of work: maximum loop iterations, units that take as long as a ray-object test, and units by
    /// which a launch may exceed its budget to complete what it has begun.
    struct Unit {
        double turns, of_test = 1, beyond = 0;
    };
    /// `most`, `all`: upper bounds of the work of one node and of all nodes.
    LaunchBudget budget(const Unit& unit, std::uint64_t most, std::uint64_t all) const;
    std::uint64_t trace_work(const Node& node, std::uint64_t packets) const;

    const NodeShare& share_;
    const NodeBuffers buffers_;
    std::uint32_t lanes_, group_, lights_ = 0, corners_ = 0;  // corners: maximum of a polygon
    std::uint32_t loop_turns_, work_per_launch_;
    bool exact_;               // the device rounds quotients and roots correctly, without our refinement loops
    std::vector<Node> nodes_;  // [slot]
};

}  // namespace raya
