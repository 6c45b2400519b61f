// All nodes of the torus on the device: their memories, queues and counters, and the kernels that they run.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/machine/machine.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/torus_renderer.hpp"

namespace raya {

/// Room that packets ask for before they are accepted or treated (kernels/shared/traffic.h).
enum class Room : cl_uint {
    kWholeTree,  // for all that a ray's tree may turn into
    kTight       // as little as can be
};

/// The kernels are launched with one work-group for each node; each step is labelled with its kernel's name.
class NodeArray {
  public:
    /// Builds the kernels with `options` as the job needs them and takes the device memory.
    NodeArray(Session& session, const TorusSettings& settings, const NodeMemories& memories, const NodeBuffers& buffers,
              const KernelOptions& options);

    /// Empty queues and boxes, counters 0, no ray made.
    void clear();

    /// Other pixels for the images that follow; at first those of the settings.
    void set_pixels(const PixelSubset& pixels);

    void inject();
    void trace_voxel(Room room);
    void route();
    /// Rays, then returns; returns the words that each link carried, [node][RAYA_LINKS].
    std::vector<std::uint64_t> exchange(const NodeStatus& status);
    void accept(Room room, std::uint32_t superstep);

    /// What the nodes say; the host waits. accept() clears what they say of one superstep.
    NodeStatus look();

    /// Return packets that have reached the root since the last call are appended.
    void gather(const NodeStatus& status, std::vector<raya_head>& returns);

    /// Packets in the outboxes that were made or changed by the node that sends them; for a trace of the traffic. To be
    /// called in every superstep; with an empty sink those of this one are left out.
    void record(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink);

    std::vector<std::uint64_t> read_events();  // [node][RAYA_EVENTS]
    PacketCounts read_made();
    PacketCounts read_ended();

    std::vector<std::uint64_t> link_packets() const;  // [node][RAYA_LINKS], since clear()
    const std::string& build_options() const { return build_options_; }
    bool words_local() const { return options_.words_local; }  // kernels copy a node's words into local memory

  private:
    using Words = const Buffer<std::uint32_t>&;
    using State = Buffer<std::uint32_t>&;
    using Counters = Buffer<std::uint64_t>&;
    using Local = LocalMemory<std::uint32_t>;
    using Run = const Buffer<raya_run>&;
    using Rays = Buffer<raya_packet>&;
    using Returns = Buffer<raya_head>&;
    using Inject = Kernel<Words, Words, Run, Local, Rays, State, Counters, Counters, Counters>;
    using Trace = Kernel<Words, Words, Run, Room, Local, Rays, State, Counters, Counters, Counters>;
    using Route = Kernel<Words, Words, Run, Local, Rays, State, State, Returns, State, Counters>;
    using Accept = Kernel<Words, Words, Run, Room, cl_uint, Words, Words, Local, Rays, State, State, State, Returns,
                          State, Counters>;

    template <class K>
    std::unique_ptr<K> build(const std::string& name, const std::vector<std::string>& all);
    /// Local memory of a kernel: `shared` words, own_words(), and the node's words where kernels copy them.
    Local local_words(std::size_t shared) const;
    std::size_t own_words() const { return options_.group_size + 1; }  // of the work-items
    PacketCounts read_packets(const Buffer<std::uint64_t>& counters);

    Session& session_;
    const TorusSettings settings_;
    NodeBuffers buffers_;
    KernelOptions options_;
    std::uint32_t nodes_, node_words_;
    Buffer<std::uint32_t> memories_, starts_;
    Buffer<raya_run> run_;
    Buffer<raya_packet> queues_;
    Buffer<std::uint32_t> status_;
    Buffer<raya_head> returns_;
    Buffer<std::uint64_t> events_, made_, ended_;
    LinkExchange rays_, homeward_;  // boxes of rays, of returns
    std::string build_options_;
    std::unique_ptr<Inject> inject_;
    std::unique_ptr<Trace> trace_;
    std::unique_ptr<Route> route_;
    std::unique_ptr<Accept> accept_;
};

}  // namespace raya
