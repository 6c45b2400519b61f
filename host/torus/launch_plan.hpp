// Work budgets of kernel launches.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/torus/node_distribution.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// Budget of a launch. The host repeats the launch until no node has work left.
struct LaunchBudget {
    std::uint32_t work = 0;      // maximum work of a node in one launch, in units that the kernel defines
    bool single_launch = false;  // true: one launch certainly completes the work; the host need not read the status

    bool operator==(const LaunchBudget&) const = default;
};

/// Limits a launch to the device's maximum number of loop iterations, and to about a second, so that Ctrl-C takes
/// effect and the GPU's watchdog does not end the launch. To set LaunchBudget::single_launch, LaunchPlan stores the
/// number of objects of each node and an upper bound of the number of packets in its queue.
class LaunchPlan {
  public:
    /// `memories`: memories of this rank's nodes, indexed by slot.
    LaunchPlan(const TorusSettings& settings, const NodeMemories& memories, const NodeDistribution& distribution,
               const NodeBuffers& buffers, const KernelOptions& options, const DeviceInfo& device);

    /// Resets the upper bounds of packets to 0.
    void clear();

    /// Updates the upper bounds of packets from `status`, which must have been read after routing or before tracing.
    /// The bound of a node is the number of packets in its queue and in the mailboxes of links that end at the node.
    void update(const NodeStatus& status);

    /// Return the budgets of the next launches. inject() also raises the upper bounds of packets to the number up
    /// to which inject.cl fills a queue.
    LaunchBudget inject();
    LaunchBudget trace_voxel() const;
    LaunchBudget route() const;
    LaunchBudget accept() const;

  private:
    struct Node {
        std::uint64_t voxels = 0;       // number of voxels of the node
        std::uint64_t max_objects = 0;  // maximum number of objects in a voxel of the node
        std::uint64_t inject_work = 0;  // work of inject in an image: numbers of rows and of pixel batches
        std::uint64_t packets = 0;      // upper bound of the number of packets in the queue
    };
    /// A kernel's unit of work.
    struct WorkUnit {
        double iterations;          // maximum number of loop iterations that a unit takes
        double units_per_test = 1;  // number of units that take as long as a ray-object test
        double overrun_units = 0;   // number of units by which a launch may exceed its budget to complete begun work
    };
    /// Returns the budget of a launch. `max_work`, `total_work`: upper bounds of the work of one node, and of all nodes
    /// together.
    LaunchBudget budget(const WorkUnit& unit, std::uint64_t max_work, std::uint64_t total_work) const;
    std::uint64_t trace_work(const Node& node, std::uint64_t packets) const;

    const NodeDistribution& distribution_;
    const NodeBuffers buffers_;
    std::uint32_t lanes_, group_size_, lights_ = 0, max_corners_ = 0;  // max_corners_: maximum over all polygons
    std::uint32_t max_loop_iterations_, work_per_launch_;
    bool rounds_correctly_;    // the device rounds quotients and square roots correctly, without refinement loops
    std::vector<Node> nodes_;  // [slot]
};

}  // namespace raya
