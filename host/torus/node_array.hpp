// The torus nodes on the device of this rank: their memories, queues and counters, and the launches of their kernels.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/array/render.hpp"
#include "host/base/log.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/ranks/ranks.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/traffic.h"

namespace raya {

/// State of the whole machine in a superstep, computed from the status of all nodes.
struct MachineState {
    std::uint64_t live = 0;           // number of packets in queues and mailboxes
    std::uint64_t full_queues = 0;    // number of full queues
    std::uint64_t progress = 0;       // sum of the nodes' RAYA_STATUS_PROGRESS; 0: no packet was processed or moved
    std::uint64_t max_cycles = 0;     // modelled cycles of the busiest node
    std::uint32_t longest_queue = 0;  // number of packets in the fullest queue
    bool all_injected = true;         // all primary rays have been generated
    double injected_fraction = 0;     // fraction of the image rows whose primary rays are generated
};

/// Computes the state from the status of all `nodes` nodes. `capacity`: capacity of a queue, in packets.
MachineState machine_state(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity);

/// Returns the progress, 0..1: the fraction of image rows whose primary rays are generated, times the mean of two
/// estimates. The first estimate is the fraction of finished packets. It is accurate as long as all nodes compute. It
/// is too high at the end, when few packets take many supersteps. The second estimate is the logarithmic decrease of
/// the number of live packets. It is accurate at the end, but too low before. `returns`: number of returns that have
/// reached the host; `max_live`: maximum number of live packets so far.
double progress_of(const MachineState& state, std::size_t returns, std::uint64_t max_live);

/// Returns [node]: modelled cycles of the node in the superstep.
std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes);

namespace node_kernels {

using InputWords = const Buffer<std::uint32_t>&;
using RunConstants = const Buffer<raya_run>&;
using FirstNode = Uint<"first_node">;           // slot of the first node of a launch
using Work = Uint<"work">;                      // work budget of a node in a launch
using Resume = Uint<"resume">;                  // 1: continue the work that the previous launch did not complete
using LocalWords = LocalMemory<std::uint32_t>;  // local memory of a work-group, which computes one node
using Queues = Buffer<raya_packet>&;
using Mailboxes = Buffer<std::uint32_t>&;
using Returns = Buffer<raya_head>&;  // returns that have reached the root
using Status = Buffer<std::uint32_t>&;
using Counters = Buffer<std::uint64_t>&;
using Processed = Buffer<raya_processed>&;

using Inject = DescribedKernel<"torus/inject.cl", "inject", InputWords, InputWords, RunConstants, FirstNode, Work,
                               Resume, LocalWords, Queues, Status, Counters, Counters, Counters>;
using TraceVoxel =
    DescribedKernel<"torus/trace_voxel.cl", "trace_voxel", InputWords, InputWords, RunConstants, FirstNode, Reserve,
                    Work, Resume, LocalWords, Queues, Status, Counters, Counters, Counters, Processed>;
using Route = DescribedKernel<"torus/route.cl", "route", InputWords, InputWords, RunConstants, FirstNode, Work, Resume,
                              LocalWords, Queues, Mailboxes, Mailboxes, Returns, Status, Counters>;
using Accept = DescribedKernel<"torus/accept.cl", "accept", InputWords, InputWords, RunConstants, Reserve, Uint<"turn">,
                               FirstNode, InputWords, InputWords, InputWords, Work, Resume, LocalWords, Queues,
                               Mailboxes, Mailboxes, Mailboxes, Returns, Status, Counters>;

}  // namespace node_kernels

/// The torus nodes of this rank. Each kernel is launched with one work-group per node, and relaunched until no node has
/// work left. Commands are labelled with the kernel's name. Functions that launch kernels throw DeviceError if the
/// device ends loops early even in the smallest launch (kernels/shared/loop_canary.clh).
class NodeArray {
  public:
    /// Builds the kernels with `options` and allocates the device memory. `memories`: memories of this rank's nodes, by
    /// slots of `distribution`. `distribution` must outlive this object.
    NodeArray(Session& session, const TorusSettings& settings, const NodeMemories& memories, const NodeBuffers& buffers,
              const KernelOptions& options, const NodeDistribution& distribution);

    /// Empties queues and mailboxes, sets counters to 0, and restarts the generation of primary rays.
    void clear();

    void inject();
    void trace_voxel(Reserve reserve);
    void route();
    /// Transfers rays and returns over the links of all nodes. Returns [node][RAYA_LINKS]: number of words charged for
    /// each link.
    std::vector<std::uint64_t> exchange(const NodeStatus& status);
    void accept(Reserve reserve, std::uint32_t superstep);

    /// Reads the status of the nodes of all ranks; blocks. RAYA_STATUS_PROGRESS and RAYA_STATUS_CYCLES are counts of
    /// the current superstep, which accept() resets.
    NodeStatus read_status();

    /// Passes the work of each node in this superstep to `sink`. Must be called after trace_voxel() and before route().
    /// `injected`: the status that read_status() returned between inject() and trace_voxel(). Requires
    /// KernelOptions::costs and a single rank.
    void report_work(const NodeStatus& injected, const NodeWorkSink& sink);

    /// In rank 0, appends to `returns` the packets that the previous continue_gather() started to read. Then starts to
    /// read the returns that have reached the root since the previous call. After the last superstep, finish_gather()
    /// appends the packets that the last continue_gather() started to read.
    void continue_gather(const NodeStatus& status, std::vector<raya_head>& returns);
    void finish_gather(std::vector<raya_head>& returns);

    /// In rank 0, passes the new messages in the outboxes of all ranks to `sink`: the charged packets
    /// (docs/glossary.md) that the outbox's node created or changed. All ranks must call record_packets() in every
    /// superstep.
    void record_packets(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink);

    /// Counts of the nodes of this rank, [slot][RAYA_EVENTS] or [slot][RAYA_KINDS].
    struct Counters {
        std::vector<std::uint64_t> events, made, ended;  // made, ended: packets (TorusResult)
    };
    Counters read_counters();

    /// Returns [node][RAYA_LINKS]: number of messages over the link since clear(), for the nodes of all ranks.
    std::vector<std::uint64_t> link_packets() const;
    const LinkExchange& ray_links() const { return ray_links_; }
    const LinkExchange& return_links() const { return return_links_; }
    const std::string& build_options() const { return build_options_; }

    /// Collective: saves or restores the state between read_status() after routing, which has returned `status`, and
    /// exchange(). finish_gather() must have been called. If the state is restored, sets `status`.
    void visit_state(RenderState& state, NodeStatus& status);
    bool copies_words_to_local() const { return options_.words_local; }  // kernels copy a node's words to local memory

  private:
    /// Repeats `launch(work, resume)` until no node has work left.
    template <class Launch>
    void launch_until_done(const std::string& label, const Launch& launch);
    /// Returns the local memory of a kernel: `work_group_words` words, plus the node's words if kernels copy them.
    LocalMemory<std::uint32_t> local_words(std::size_t work_group_words) const;

    Session& session_;
    const TorusSettings settings_;
    NodeBuffers buffers_;
    const NodeDistribution& distribution_;
    std::uint32_t nodes_, node_words_;  // number of nodes of this rank; number of words of the fullest of these nodes
    KernelOptions options_;
    Kernels kernels_;
    Buffer<std::uint32_t> memories_, starts_;
    Buffer<raya_run> run_;
    Buffer<raya_packet> queues_;
    Buffer<std::uint32_t> status_, inbox_of_link_;
    Buffer<raya_head> returns_;
    Readback<raya_head> returns_readback_;
    std::size_t returns_pending_ = 0;  // number of returns that returns_readback_ is reading
    Buffer<std::uint64_t> events_, made_, ended_;
    Buffer<raya_processed> processed_;
    LaunchLoop<raya_packet, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, raya_head, std::uint32_t,
               std::uint64_t, std::uint64_t, std::uint64_t>
        launches_{"fewer objects in a voxel (--voxels), a shorter --queue"};
    Clock::time_point last_status_;          // time of the last read_status()
    std::optional<double> superstep_s_;      // time between the last two; empty in the first superstep
    LinkExchange ray_links_, return_links_;  // mailboxes of rays; mailboxes of returns
    node_kernels::Inject inject_;
    node_kernels::TraceVoxel trace_;
    node_kernels::Route route_;
    node_kernels::Accept accept_;
    std::string build_options_;
};

}  // namespace raya
