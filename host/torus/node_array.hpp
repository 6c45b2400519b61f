// The nodes of the torus that are on this rank's device: their memories, queues and counters, and the kernels that they
// run.
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

/// Packets that live, or rays that have still to be made.
struct Census {
    std::uint64_t live = 0, full = 0, progress = 0, cycles = 0;  // full: queues; cycles: of the busiest node
    std::uint32_t fullest = 0;                                   // packets in the fullest queue
    bool all_made = true;
    double looked = 0;  // share of the rows that nodes have looked at
};

/// `capacity`: packets that a queue holds.
Census census_of(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity);

/// Modelled cycles of each node in the superstep.
std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes);

/// Room that packets ask for before they are accepted or treated (kernels/shared/traffic.h).
enum class Room : cl_uint {
    kWholeTree,  // for all that a ray's tree may turn into
    kTight       // as little as can be
};

namespace node_kernels {

using Words = const Buffer<std::uint32_t>&;  // of all nodes, where each one's start, where boxes have been sent
using Run = const Buffer<raya_run>&;
using First = Uint<"first_node">;        // slot of the first node that a launch is for
using Work = Uint<"work">;               // of a node in a launch
using Again = Uint<"again">;             // 1: a launch goes on with what the last one has left
using Own = LocalMemory<std::uint32_t>;  // of one node
using Queues = Buffer<raya_packet>&;
using Boxes = Buffer<std::uint32_t>&;
using Returns = Buffer<raya_head>&;  // at the root
using Status = Buffer<std::uint32_t>&;
using Counters = Buffer<std::uint64_t>&;
using Treated = Buffer<raya_treated>&;

using Inject = DescribedKernel<"torus/inject.cl", "inject", Words, Words, Run, First, Work, Again, Own, Queues, Status,
                               Counters, Counters, Counters>;
using TraceVoxel = DescribedKernel<"torus/trace_voxel.cl", "trace_voxel", Words, Words, Run, First, Room, Work, Again,
                                   Own, Queues, Status, Counters, Counters, Counters, Treated>;
using Route = DescribedKernel<"torus/route.cl", "route", Words, Words, Run, First, Work, Again, Own, Queues, Boxes,
                              Boxes, Returns, Status, Counters>;
using Accept = DescribedKernel<"torus/accept.cl", "accept", Words, Words, Run, Room, Uint<"turn">, First, Words, Words,
                               Words, Work, Again, Own, Queues, Boxes, Boxes, Boxes, Returns, Status, Counters>;

}  // namespace node_kernels

/// The kernels are launched with one work-group for each node, again and again where a launch leaves something to do;
/// each step is labelled with its kernel's name. DeviceError where the device ends loops even of the smallest launch.
class NodeArray {
  public:
    /// Builds the kernels with `options` as the job needs them and takes the device memory. `memories` has the nodes of
    /// `share`, in the order of its slots; `ranks` and `share` outlive this.
    NodeArray(Session& session, const TorusSettings& settings, const NodeMemories& memories, const NodeBuffers& buffers,
              const KernelOptions& options, const NodeShare& share, Ranks& ranks);

    /// Empty queues and boxes, counters 0, no ray made.
    void clear();

    /// Other pixels for the images that follow; at first those of the settings.
    void set_pixels(const PixelSubset& pixels);

    /// Nodes in neighbouring slots.
    struct Slots {
        std::uint32_t first = 0, count = 0;
    };
    Slots all() const { return {0, nodes_}; }
    Slots inner() const { return {0, share_.inner()}; }  // whose links all end here
    Slots border() const { return {share_.inner(), nodes_ - share_.inner()}; }

    void inject(Slots nodes);
    void trace_voxel(Slots nodes, Room room);
    void route();
    /// Rays, then returns; returns the words that each link is charged for, [node][RAYA_LINKS]. What goes to other
    /// ranks is on its way when this returns: only inner nodes may accept until arrive() has waited for it.
    std::vector<std::uint64_t> exchange(const NodeStatus& status);
    void arrive();
    void accept(Slots nodes, Room room, std::uint32_t superstep);

    /// What the nodes of all ranks say; the host waits. accept() clears what they say of one superstep.
    NodeStatus look();

    /// What trace_voxel has done in each node, after inject and trace_voxel and before route; `injected` is what the
    /// nodes said between those two. For kernels that tell what packets cost (KernelOptions::costs), on one rank.
    void tell_work(const NodeStatus& injected, const NodeWorkSink& sink);

    /// Return packets that wait at the root are on their way to the host when this returns, in rank 0; those of the
    /// last call are appended to `returns`. After the last superstep gather_rest() appends what is on its way still.
    void gather(const NodeStatus& status, std::vector<raya_head>& returns);
    void gather_rest(std::vector<raya_head>& returns);

    /// Messages in the outboxes that were made or changed by the node that sends them; for a trace of the traffic. To
    /// be called in every superstep; with an empty sink, in all ranks alike, those of this one are left out. Rank 0 is
    /// told of those of all ranks.
    void record(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink);

    std::vector<std::uint64_t> read_events();  // [node][RAYA_EVENTS] of all nodes, in rank 0; elsewhere nothing
    PacketCounts read_made();                  // of all ranks
    PacketCounts read_ended();

    std::vector<std::uint64_t> link_packets() const;  // [node][RAYA_LINKS], since clear(): messages; of all ranks
    bool links_by_kernel() const { return links_by_kernel_; }          // else by copies
    const std::string& links_origin() const { return links_origin_; }  // who chose: see TorusResult
    std::uint64_t moved_rays() const { return rays_.moved(); }
    std::uint64_t moved_returns() const { return homeward_.moved(); }
    const std::string& build_options() const { return build_options_; }
    bool words_local() const { return options_.words_local; }  // kernels copy a node's words into local memory

  private:
    NodeArray(Kernels kernels, const TorusSettings& settings, const NodeMemories& memories, const NodeBuffers& buffers,
              const NodeShare& share, Ranks& ranks);
    void write_ways_in();
    void choose_link_move(Kernels& kernels);
    void use_kernel(const ExchangeKernel& kernel);
    double exchange_seconds();
    /// Launches by `launch(work, again)` until no node of `nodes` has anything left.
    template <class Launch>
    void launch_all(const std::string& label, Slots nodes, const LaunchBudget& budget, Launch&& launch);
    std::vector<PacketRecord> records_of_all(const std::vector<PacketRecord>& own);
    std::vector<std::size_t> sizes(std::size_t of_node) const;  // [rank]: elements, so many of each of its nodes
    /// Local memory of a kernel: `shared` words, and the node's where kernels copy them.
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
    Buffer<std::uint32_t> status_, ways_in_;
    Buffer<raya_head> returns_;
    Landing<raya_head> returns_here_;
    std::size_t returns_coming_ = 0;  // into returns_here_
    Buffer<std::uint64_t> events_, made_, ended_;
    Buffer<raya_treated> treated_;
    LaunchGuard<raya_packet, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, raya_head, std::uint32_t,
                std::uint64_t, std::uint64_t, std::uint64_t>
        guard_;
    LinkExchange rays_, homeward_;  // boxes of rays, of returns
    node_kernels::Inject inject_;
    node_kernels::TraceVoxel trace_;
    node_kernels::Route route_;
    node_kernels::Accept accept_;
    bool links_by_kernel_ = false;
    std::string links_origin_;
    std::string build_options_;
};

}  // namespace raya
