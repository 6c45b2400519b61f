#include "host/torus/node_array.hpp"

#include <algorithm>

#include "host/torus/census.hpp"
#include "kernels/shared/node_counts.h"

namespace raya {
namespace {

std::uint32_t largest_node(const NodeMemories& memories) {
    std::uint32_t largest = 0;
    for (std::size_t i = 0; i + 1 < memories.starts.size(); ++i)
        largest = std::max(largest, memories.starts[i + 1] - memories.starts[i]);
    return largest;
}

std::size_t own_words(const KernelOptions& options) { return options.group_size + 1; }  // of the work-items

// Kernels copy a node's words into local memory where it has room for them beside what work-items share.
KernelOptions where_words_fit(KernelOptions options, const NodeMemories& memories, const DeviceInfo& device) {
    const std::size_t most_shared = std::max<std::size_t>(RAYA_COUNT_WORDS, RAYA_ROUTE_WORDS);
    const std::size_t words = most_shared + own_words(options) + largest_node(memories);
    options.words_local = options.words_local && sizeof(std::uint32_t) * words <= device.local_memory_bytes;
    return options;
}

bool is_return(const raya_head& packet) { return raya_state_kind(packet.state) == RAYA_KIND_RETURN; }

// Whether a packet in an outbox is a message that its node has made.
bool is_new_message(const raya_head& packet) {
    return packet.state & RAYA_STATE_FRESH && (!is_return(packet) || packet.state & RAYA_STATE_CHARGED);
}

PacketRecord record_of(const TorusSettings& settings, std::uint32_t superstep, std::uint32_t node,
                       const raya_head& packet) {
    PacketRecord record{.superstep = superstep,
                        .source = node,
                        .destination = RAYA_ROOT,
                        .head = packet,
                        .words = settings.packets.return_words()};
    if (is_return(packet)) return record;
    record.words = settings.packets.ray_words;
    const raya_torus& torus = settings.torus;
    const raya_place v = raya_unpack_place(packet.voxel);
    record.destination =
        raya_node_of(torus, v.at[0] % torus.nodes[0], v.at[1] % torus.nodes[1], v.at[2] % torus.nodes[2]);
    return record;
}

// What ranks have of their nodes, `each` words of every one, in the order of ranks and slots: as [node][each].
template <class T>
std::vector<T> in_order_of_nodes(const NodeShare& share, std::uint32_t ranks, const std::vector<T>& of_ranks,
                                 std::size_t each) {
    if (ranks == 1) return of_ranks;
    std::vector<T> ordered(of_ranks.size());
    auto from = of_ranks.begin();
    for (std::uint32_t rank = 0; rank < ranks; ++rank)
        for (const std::uint32_t node : share.nodes_of(rank)) {
            std::copy_n(from, each, ordered.begin() + static_cast<std::ptrdiff_t>(each * node));
            from += static_cast<std::ptrdiff_t>(each);
        }
    return ordered;
}

}  // namespace

NodeArray::NodeArray(Session& session, const TorusSettings& settings, const NodeMemories& memories,
                     const NodeBuffers& buffers, const KernelOptions& options, const NodeShare& share, Ranks& ranks)
    : NodeArray(Kernels(session, where_words_fit(options, memories, session.device()), settings.kernels.sources),
                settings, memories, buffers, share, ranks) {}

NodeArray::NodeArray(Kernels kernels, const TorusSettings& settings, const NodeMemories& memories,
                     const NodeBuffers& buffers, const NodeShare& share, Ranks& ranks)
    : session_(kernels.session()),
      settings_(settings),
      buffers_(buffers),
      share_(share),
      ranks_(ranks),
      nodes_(share.nodes()),
      node_words_(largest_node(memories)),
      options_(kernels.options()),
      memories_(session_.buffer<std::uint32_t>("node memories", memories.words.size())),
      starts_(session_.buffer<std::uint32_t>("starts of node memories", memories.starts.size())),
      run_(session_.buffer<raya_run>("run", 1)),
      queues_(session_.buffer<raya_packet>("queues", std::size_t{nodes_} * buffers.queue)),
      status_(session_.buffer<std::uint32_t>("status", std::size_t{nodes_} * RAYA_STATUS_WORDS)),
      ways_in_(session_.buffer<std::uint32_t>("ways in", std::size_t{nodes_} * RAYA_LINKS)),
      returns_(session_.buffer<raya_head>("returns", share.has(RAYA_ROOT) ? buffers.queue : 1)),
      events_(session_.buffer<std::uint64_t>("events", std::size_t{nodes_} * RAYA_EVENTS)),
      made_(session_.buffer<std::uint64_t>("packets made", std::size_t{nodes_} * RAYA_KINDS)),
      ended_(session_.buffer<std::uint64_t>("packets ended", std::size_t{nodes_} * RAYA_KINDS)),
      treated_(session_.buffer<raya_treated>("treated packets", options_.costs ? queues_.size() : 1)),
      rays_(session_, share, buffers.box,
            {"exchange", RAYA_PACKET_WORDS, RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX, settings.packets.ray_words}),
      homeward_(session_, share, buffers.box,
                {"return", RAYA_RETURN_WORDS, RAYA_STATUS_RETURN_OUTBOX, RAYA_STATUS_RETURN_INBOX,
                 settings.packets.return_words(), RAYA_STATUS_RETURN_CHARGED, 1}),
      inject_(kernels.get<node_kernels::Inject>()),
      trace_(kernels.get<node_kernels::TraceVoxel>()),
      route_(kernels.get<node_kernels::Route>()),
      accept_(kernels.get<node_kernels::Accept>()),
      build_options_(kernels.program(node_kernels::Accept::kFile).options()) {
    session_.write("scatter", memories_, memories.words);
    session_.write("scatter", starts_, memories.starts);
    write_ways_in();
    set_pixels(settings.pixels);
}

void NodeArray::write_ways_in() {
    std::vector<std::uint32_t> ways;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (const std::uint32_t node : share_.own())
            ways.push_back(share_.inbox(link, raya_link_end(settings_.torus, node, link ^ 1u)));
    session_.write("scatter", ways_in_, ways);
}

void NodeArray::set_pixels(const PixelSubset& pixels) {
    const raya_run run{.nodes = nodes_,
                       .inboxes = share_.inboxes(),
                       .queue = buffers_.queue,
                       .box = buffers_.box,
                       .host = buffers_.queue,
                       .stride = pixels.stride,
                       .offset = pixels.first,
                       .root_injects = settings_.inject == Injection::kRoot || raya_nodes(settings_.torus) == 1,
                       .return_a_ray = settings_.packets.return_a_ray};
    session_.write("scatter", run_, {&run, 1});
}

LocalMemory<std::uint32_t> NodeArray::local_words(std::size_t shared) const {
    return {shared + own_words(options_) + (options_.words_local ? node_words_ : 0)};
}

void NodeArray::clear() {
    session_.fill("clear", status_, 0);
    session_.fill("clear", events_, 0);
    session_.fill("clear", made_, 0);
    session_.fill("clear", ended_, 0);
    rays_.clear();
    homeward_.clear();
}

void NodeArray::inject(Slots nodes) {
    if (nodes.count == 0) return;
    session_.launch("inject", inject_, nodes.count, options_.group_size, memories_, starts_, run_,
                    node_kernels::First{nodes.first}, local_words(RAYA_COUNT_WORDS), queues_, status_, events_, made_,
                    ended_);
}

void NodeArray::trace_voxel(Slots nodes, Room room) {
    if (nodes.count == 0) return;
    session_.launch("trace_voxel", trace_, nodes.count, options_.group_size, memories_, starts_, run_,
                    node_kernels::First{nodes.first}, room, local_words(RAYA_COUNT_WORDS), queues_, status_, events_,
                    made_, ended_, treated_);
}

void NodeArray::route() {
    session_.launch("route", route_, nodes_, options_.group_size, memories_, starts_, run_, node_kernels::First{0},
                    local_words(RAYA_ROUTE_WORDS), queues_, rays_.outboxes(), homeward_.outboxes(), returns_, status_,
                    ended_);
}

void NodeArray::accept(Slots nodes, Room room, std::uint32_t superstep) {
    if (nodes.count == 0) return;
    session_.launch("accept", accept_, nodes.count, options_.group_size, memories_, starts_, run_, room,
                    Uint<"turn">{superstep}, node_kernels::First{nodes.first}, ways_in_, rays_.sent(), homeward_.sent(),
                    LocalMemory<std::uint32_t>{options_.group_size + 1}, queues_, rays_.inboxes(), homeward_.inboxes(),
                    homeward_.outboxes(), returns_, status_, ended_);
}

std::vector<std::uint64_t> NodeArray::exchange(const NodeStatus& status) {
    if (ranks_.many()) {
        std::vector<Outgoing> out;
        std::vector<Incoming> in;
        rays_.leave(status, out, in);
        homeward_.leave(status, out, in);
        ranks_.start(out, in);
    }
    std::vector<std::uint64_t> words(std::size_t{raya_nodes(settings_.torus)} * RAYA_LINKS);
    rays_.exchange(status, words);
    homeward_.exchange(status, words);
    return words;
}

void NodeArray::arrive() {
    if (!ranks_.many()) return;
    session_.flush();  // the device computes while the host waits
    ranks_.wait();
    rays_.arrive();
    homeward_.arrive();
}

std::vector<std::uint64_t> NodeArray::link_packets() const {
    std::vector<std::uint64_t> packets = rays_.packets();
    for (std::size_t i = 0; i < packets.size(); ++i) packets[i] += homeward_.packets()[i];
    return packets;
}

NodeStatus NodeArray::look() {
    std::vector<std::uint32_t> own(status_.size());
    session_.read("look", status_, own);
    const std::vector<std::uint32_t> all =
        ranks_.all_gather(std::span<const std::uint32_t>(own), sizes(RAYA_STATUS_WORDS));
    return NodeStatus(in_order_of_nodes(share_, ranks_.count(), all, RAYA_STATUS_WORDS));
}

std::vector<std::size_t> NodeArray::sizes(std::size_t of_node) const {
    std::vector<std::size_t> sizes;
    for (std::uint32_t rank = 0; rank < ranks_.count(); ++rank) sizes.push_back(of_node * share_.nodes_of(rank).size());
    return sizes;
}

void NodeArray::tell_work(const NodeStatus& injected, const NodeWorkSink& sink) {
    const NodeStatus status = look();
    const std::vector<std::uint64_t> cycles = cycles_of_nodes(injected, nodes_);
    std::vector<raya_treated> treated;
    std::vector<raya_packet> queue;
    for (std::uint32_t node = 0; node < nodes_; ++node) {
        treated.resize(injected.at(node, RAYA_STATUS_QUEUE));
        queue.resize(status.at(node, RAYA_STATUS_QUEUE));
        session_.read("history", treated_, treated, std::size_t{node} * buffers_.queue);
        session_.read("history", queues_, queue, std::size_t{node} * buffers_.queue);
        sink({node, cycles[node], treated, queue});
    }
}

void NodeArray::gather(const NodeStatus& status, std::vector<raya_head>& returns) {
    if (!share_.has(RAYA_ROOT)) return;
    const std::size_t waiting = status.at(RAYA_ROOT, RAYA_STATUS_HOST), before = returns.size();
    returns.resize(before + waiting);
    session_.read("gather", returns_, std::span(returns).subspan(before));
}

void NodeArray::record(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink) {
    if (!sink) {
        rays_.visit_new(status, {});
        return homeward_.visit_new(status, {});
    }
    std::vector<PacketRecord> own;
    const auto take = [&](std::uint32_t node, const raya_head& packet) {
        if (is_new_message(packet)) own.push_back(record_of(settings_, superstep, node, packet));
    };
    rays_.visit_new(status, take);
    homeward_.visit_new(status, take);
    std::vector<PacketRecord> records = ranks_.many() ? records_of_all(own) : std::move(own);
    std::stable_sort(records.begin(), records.end(),
                     [](const PacketRecord& a, const PacketRecord& b) { return a.source < b.source; });
    for (const PacketRecord& record : records) sink(record);
}

std::vector<PacketRecord> NodeArray::records_of_all(const std::vector<PacketRecord>& own) {
    return ranks_.gather(std::span(own), ranks_.all_gather(own.size()));
}

std::vector<std::uint64_t> NodeArray::read_events() {
    std::vector<std::uint64_t> own(events_.size());
    session_.read("read counters", events_, own);
    const std::vector<std::uint64_t> all = ranks_.gather(std::span<const std::uint64_t>(own), sizes(RAYA_EVENTS));
    return all.empty() ? all : in_order_of_nodes(share_, ranks_.count(), all, RAYA_EVENTS);
}

PacketCounts NodeArray::read_packets(const Buffer<std::uint64_t>& counters) {
    std::vector<std::uint64_t> all(counters.size());
    session_.read("read counters", counters, all);
    PacketCounts own{}, sum{};
    for (std::size_t i = 0; i < all.size(); ++i) own[i % RAYA_KINDS] += all[i];
    for (const PacketCounts& of_rank : ranks_.all_gather(own))
        for (std::size_t kind = 0; kind < RAYA_KINDS; ++kind) sum[kind] += of_rank[kind];
    return sum;
}

PacketCounts NodeArray::read_made() { return read_packets(made_); }
PacketCounts NodeArray::read_ended() { return read_packets(ended_); }

}  // namespace raya
