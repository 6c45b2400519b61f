// How much the nodes do in one launch of a kernel, and whether one launch will do.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// A kernel of the nodes ends after so much `work` of a node, in the kernel's own units, and is launched again until
/// nothing is left. `once`: the first launch leaves nothing, whatever it finds.
struct LaunchBudget {
    std::uint32_t work = 0;
    bool once = false;

    bool operator==(const LaunchBudget&) const = default;
};

/// Launches last no longer than about a second, so that Ctrl-C is heard and a GPU's watchdog sleeps, and no longer than
/// a device lets loops turn. The plan knows what each node holds and how many packets may be in it, so that a host need
/// not ask after every launch whether something is left.
class LaunchPlan {
  public:
    /// `memories` has the nodes of `share`, in the order of its slots.
    LaunchPlan(const TorusSettings& settings, const NodeMemories& memories, const NodeShare& share,
               const NodeBuffers& buffers, const KernelOptions& options, const DeviceInfo& device);

    /// Queues and boxes are empty, no ray is made.
    void clear();

    /// The nodes say so, after packets were routed or before they are traced. All that waits for a node, in its queue
    /// or in boxes of links that lead there, may come to be in its queue before the next look.
    void look(const NodeStatus& status);

    /// Of the next launches. After inject() queues may hold what it may make.
    LaunchBudget inject();
    LaunchBudget trace_voxel() const;
    LaunchBudget route() const;
    LaunchBudget accept() const;

  private:
    struct Node {
        std::uint64_t voxels = 0;   // that it holds
        std::uint64_t most = 0;     // objects in one of them
        std::uint64_t looks = 0;    // at rows and pixels of them, as inject counts them, for an image
        std::uint64_t packets = 0;  // that its queue may hold
    };
    /// A kernel's unit of work: how often loops turn for it at most, how many take as long as a test of a packet's ray,
    /// and how many a launch may do beyond its budget, as it ends what it has begun.
    struct Unit {
        double turns, of_test = 1, beyond = 0;
    };
    /// `most`: that a node may find to do, `all`: that all may.
    LaunchBudget budget(const Unit& unit, std::uint64_t most, std::uint64_t all) const;
    std::uint64_t trace_work(const Node& node, std::uint64_t packets) const;

    const NodeShare& share_;
    const NodeBuffers buffers_;
    std::uint32_t lanes_, group_, lights_ = 0, corners_ = 0;  // corners: of the polygon that has most
    std::uint32_t loop_turns_, work_per_launch_;
    bool exact_;               // the device rounds quotients and roots correctly, without loops of ours
    std::vector<Node> nodes_;  // [slot]
};

}  // namespace raya
