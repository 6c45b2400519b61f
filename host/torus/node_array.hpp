// The nodes of the torus on this rank's device: their memories, queues and counters, and the launches of their kernels.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/kernels.hpp"
#include "host/ranks/ranks.hpp"
#include "host/torus/launch_plan.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_settings.hpp"
#include "kernels/shared/traffic.h"

namespace raya {

/// State of the whole machine in a superstep.
struct Census {
    std::uint64_t live = 0;      // packets in queues and mailboxes
    std::uint64_t full = 0;      // full queues
    std::uint64_t progress = 0;  // 0 if no packet was processed or moved
    std::uint64_t cycles = 0;    // of the busiest node
    std::uint32_t fullest = 0;   // packets in the fullest queue
    bool all_made = true;        // no primary ray is left to be made
    double scanned = 0;          // share of the image rows that nodes have made primary rays for, 0..1
};

/// `capacity`: packets that a queue holds.
Census census_of(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity);

/// [node]: modelled cycles in the superstep.
std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes);

/// Free slots that a packet needs before a node accepts or processes it (kernels/shared/traffic.h).
enum class Reserve : cl_uint {
    kWholeTree,  // the slots of the packet's whole ray tree
    kTight       // the minimum, to resolve a stall
};

namespace node_kernels {

using Words = const Buffer<std::uint32_t>&;
using Run = const Buffer<raya_run>&;
using First = Uint<"first_node">;        // slot of the first node of a launch
using Work = Uint<"work">;               // work budget of a node in a launch
using Again = Uint<"again">;             // 1: the launch continues the work that the last one left
using Own = LocalMemory<std::uint32_t>;  // of a node's work-group
using Queues = Buffer<raya_packet>&;
using Boxes = Buffer<std::uint32_t>&;
using Returns = Buffer<raya_head>&;  // at the root
using Status = Buffer<std::uint32_t>&;
using Counters = Buffer<std::uint64_t>&;
using Processed = Buffer<raya_processed>&;

using Inject = DescribedKernel<"torus/inject.cl", "inject", Words, Words, Run, First, Work, Again, Own, Queues, Status,
                               Counters, Counters, Counters>;
using TraceVoxel = DescribedKernel<"torus/trace_voxel.cl", "trace_voxel", Words, Words, Run, First, Reserve, Work,
                                   Again, Own, Queues, Status, Counters, Counters, Counters, Processed>;
using Route = DescribedKernel<"torus/route.cl", "route", Words, Words, Run, First, Work, Again, Own, Queues, Boxes,
                              Boxes, Returns, Status, Counters>;
using Accept = DescribedKernel<"torus/accept.cl", "accept", Words, Words, Run, Reserve, Uint<"turn">, First, Words,
                               Words, Words, Work, Again, Own, Queues, Boxes, Boxes, Boxes, Returns, Status, Counters>;

}  // namespace node_kernels

/// Kernels are launched with one work-group for each node, and again until no work is left. Commands are labelled with
/// the kernel's name. Throws DeviceError if the device ends loops early even in the smallest launch.
class NodeArray {
  public:
    /// Builds the kernels with `options` and allocates the device memory. `memories`: of the nodes of `share`, in the
    /// order of its slots. `ranks` and `share` must outlive this.
    NodeArray(Session& session, const TorusSettings& settings, const NodeMemories& memories, const NodeBuffers& buffers,
              const KernelOptions& options, const NodeShare& share, Ranks& ranks);

    /// Resets to empty queues and mailboxes, counters of 0, and no ray made.
    void clear();

    /// Sets the pixels of the following images; initially those of the settings.
    void set_pixels(const PixelSubset& pixels);

    /// A range of slots.
    struct Slots {
        std::uint32_t first = 0, count = 0;
    };
    Slots all() const { return {0, nodes_}; }
    Slots inner() const { return {0, share_.inner()}; }  // nodes without links to other ranks
    Slots border() const { return {share_.inner(), nodes_ - share_.inner()}; }

    void inject(Slots nodes);
    void trace_voxel(Slots nodes, Reserve reserve);
    void route();
    /// Transfers rays and returns over the links of all nodes. Returns the words that each link is charged for,
    /// [node][RAYA_LINKS]. Messages between ranks are still pending on return: only inner nodes may accept before
    /// arrive(), which waits for them.
    std::vector<std::uint64_t> exchange(const NodeStatus& status);
    void arrive();
    void accept(Slots nodes, Reserve reserve, std::uint32_t superstep);

    /// Reads the status of the nodes of all ranks; blocks. accept() resets the part that is counted by superstep.
    NodeStatus look();

    /// Reports the work of trace_voxel in each node. To be called after trace_voxel and before route; `injected`: the
    /// status between inject and trace_voxel. Requires KernelOptions::costs and a single rank.
    void report_work(const NodeStatus& injected, const NodeWorkSink& sink);

    /// In rank 0, starts to read back the returns that wait at the root, and appends those of the last call to
    /// `returns`. After the last superstep, gather_remaining() appends the pending ones.
    void gather(const NodeStatus& status, std::vector<raya_head>& returns);
    void gather_remaining(std::vector<raya_head>& returns);

    /// Passes the messages in the outboxes that the sending node made or changed to `sink`, in rank 0 those of all
    /// ranks. Must be called in every superstep; an empty sink, in all ranks alike, skips the superstep.
    void record(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink);

    std::vector<std::uint64_t> read_events();  // [node][RAYA_EVENTS] of all nodes, in rank 0; empty in others
    PacketCounts read_made();                  // of all ranks
    PacketCounts read_ended();

    std::vector<std::uint64_t> link_packets() const;  // [node][RAYA_LINKS]: messages since clear(), of all ranks
    bool links_by_kernel() const { return links_by_kernel_; }          // else by copies
    const std::string& links_origin() const { return links_origin_; }  // see TorusResult
    std::uint64_t moved_rays() const { return ray_links_.moved(); }
    std::uint64_t moved_returns() const { return return_links_.moved(); }
    const std::string& build_options() const { return build_options_; }
    bool words_local() const { return options_.words_local; }  // kernels copy a node's words into local memory

  private:
    NodeArray(Kernels kernels, const TorusSettings& settings, const NodeMemories& memories, const NodeBuffers& buffers,
              const NodeShare& share, Ranks& ranks);
    void write_inbox_table();
    void choose_link_move(Kernels& kernels);
    void use_kernel(const ExchangeKernel& kernel);
    double exchange_seconds();
    /// Repeats `launch(work, again)` until no node of `nodes` has work left.
    template <class Launch>
    void launch_all(const std::string& label, Slots nodes, const LaunchBudget& budget, Launch&& launch);
    std::vector<PacketRecord> records_of_all(const std::vector<PacketRecord>& own);
    std::vector<std::size_t> sizes(std::size_t of_node) const;  // [rank]: elements, `of_node` for each of its nodes
    /// Local memory of a kernel: `shared` words, and the node's words if kernels copy them.
    LocalMemory<std::uint32_t> local_words(std::size_t shared) const;
    PacketCounts read_packets(const Buffer<std::uint64_t>& counters);

    Session& session_;
    const TorusSettings settings_;
    NodeBuffers buffers_;
    const NodeShare& share_;
    Ranks& ranks_;
    std::uint32_t nodes_, node_words_;  // nodes: on this device
    KernelOptions options_;
    LaunchPlan plan_;
    Buffer<std::uint32_t> memories_, starts_;
    Buffer<raya_run> run_;
    Buffer<raya_packet> queues_;
    Buffer<std::uint32_t> status_, inbox_of_link_;
    Buffer<raya_head> returns_;
    Readback<raya_head> returns_readback_;
    std::size_t returns_pending_ = 0;  // into returns_readback_
    Buffer<std::uint64_t> events_, made_, ended_;
    Buffer<raya_processed> processed_;
    LaunchGuard<raya_packet, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, raya_head, std::uint32_t,
                std::uint64_t, std::uint64_t, std::uint64_t>
        guard_;
    LinkExchange ray_links_, return_links_;  // mailboxes of rays, of returns
    node_kernels::Inject inject_;
    node_kernels::TraceVoxel trace_;
    node_kernels::Route route_;
    node_kernels::Accept accept_;
    bool links_by_kernel_ = false;
    std::string links_origin_;
    std::string build_options_;
};

}  // namespace raya
