#include "host/torus/node_array.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/shared/node_counts.h"

namespace raya {
namespace {

std::uint32_t max_node_words(const NodeMemories& memories) {
    std::uint32_t max_words = 0;
    for (std::size_t i = 0; i + 1 < memories.starts.size(); ++i)
        max_words = std::max(max_words, memories.starts[i + 1] - memories.starts[i]);
    return max_words;
}

constexpr std::size_t kRowWords = 4;  // the words of each node start at a multiple of kRowWords

// Sets `words_local` to false if the node's words and the work-group's other data do not fit the local memory, or if
// the device may end loops early. Such devices are CPUs, whose local memory is not faster than global memory.
KernelOptions choose_words_local(KernelOptions options, const NodeMemories& memories, const DeviceInfo& device) {
    const std::size_t work_group_words =
        std::max(RAYA_INJECT_WORDS(options.group_size, options.lanes), RAYA_ROUTE_WORDS(options.group_size));
    const std::size_t bytes = sizeof(std::uint32_t) * (work_group_words + kRowWords + max_node_words(memories));
    options.words_local = options.words_local && bytes <= device.local_memory_bytes && !device.ends_loops_early;
    return options;
}

// Returns true if status word `word` of any node is not 0.
bool any_node_has(std::span<const std::uint32_t> status, std::size_t word) {
    for (std::size_t i = word; i < status.size(); i += RAYA_STATUS_WORDS)
        if (status[i] > 0) return true;
    return false;
}

}  // namespace

NodeArray::NodeArray(Session& session, const TorusSettings& settings, const NodeMemories& memories,
                     const NodeBuffers& buffers, const KernelOptions& options, const NodeDistribution& distribution)
    : session_(session),
      settings_(settings),
      buffers_(buffers),
      distribution_(distribution),
      nodes_(distribution.count()),
      node_words_(max_node_words(memories)),
      options_(choose_words_local(options, memories, session.device())),
      kernels_(session, options_, settings.kernels.sources),
      memories_(session_.buffer_of("node memories", std::span(memories.words))),
      starts_(session_.buffer<std::uint32_t>("starts of node memories", memories.starts.size())),
      run_(session_.buffer<raya_run>("run", 1)),
      queues_(session_.buffer<raya_packet>("queues", std::size_t{nodes_} * buffers.queue)),
      status_(session_.buffer<std::uint32_t>("status", std::size_t{nodes_} * RAYA_STATUS_WORDS)),
      inbox_of_link_(session_.buffer<std::uint32_t>("inboxes of links", std::size_t{nodes_} * RAYA_LINKS)),
      returns_(session_.buffer<raya_head>("returns", distribution.has(RAYA_ROOT) ? buffers.queue : 1)),
      returns_readback_(returns_.size()),
      events_(session_.buffer<std::uint64_t>("events", std::size_t{nodes_} * RAYA_EVENTS)),
      made_(session_.buffer<std::uint64_t>("packets made", std::size_t{nodes_} * RAYA_KINDS)),
      ended_(session_.buffer<std::uint64_t>("packets ended", std::size_t{nodes_} * RAYA_KINDS)),
      processed_(session_.buffer<raya_processed>("processed packets", options_.costs ? queues_.size() : 1)),
      ray_links_(session_, distribution, buffers.box,
                 {"exchange", RAYA_PACKET_WORDS, RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX, settings.packets.ray_words},
                 kernels_.get<ExchangeKernel>(), options_.group_size, status_),
      return_links_(session_, distribution, buffers.box,
                    {"return", RAYA_RETURN_WORDS, RAYA_STATUS_RETURN_OUTBOX, RAYA_STATUS_RETURN_INBOX,
                     settings.packets.return_words(), RAYA_STATUS_RETURN_CHARGED, 1},
                    kernels_.get<ExchangeKernel>(), options_.group_size, status_),
      inject_(kernels_.get<node_kernels::Inject>()),
      trace_(kernels_.get<node_kernels::TraceVoxel>()),
      route_(kernels_.get<node_kernels::Route>()),
      accept_(kernels_.get<node_kernels::Accept>()),
      build_options_(kernels_.program(node_kernels::TraceVoxel::kFile).options()) {
    session_.write("scatter", memories_, memories.words);
    session_.write("scatter", starts_, memories.starts);
    std::vector<std::uint32_t> inboxes;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (const std::uint32_t node : distribution.own())
            inboxes.push_back(distribution.inbox_from(raya_link_end(settings.torus, node, link ^ 1u), link));
    session_.write("scatter", inbox_of_link_, inboxes);
    const raya_run run{.nodes = nodes_,
                       .inboxes = distribution_.inboxes(),
                       .queue = buffers_.queue,
                       .box = buffers_.box,
                       .host = buffers_.queue,
                       .stride = settings_.pixels.stride,
                       .offset = settings_.pixels.first,
                       .root_injects = settings_.inject == Injection::kRoot || raya_nodes(settings_.torus) == 1,
                       .one_return_per_ray = settings_.packets.one_return_per_ray};
    session_.write("scatter", run_, {&run, 1});
}

LocalMemory<std::uint32_t> NodeArray::local_words(std::size_t work_group_words) const {
    return {work_group_words + (options_.words_local ? node_words_ + kRowWords : 0)};
}

void NodeArray::clear() {
    session_.fill("clear", status_, 0);
    session_.fill("clear", events_, 0);
    session_.fill("clear", made_, 0);
    session_.fill("clear", ended_, 0);
    ray_links_.clear();
    return_links_.clear();
    superstep_s_.reset();
    last_status_ = Clock::now();
    returns_pending_ = 0;
}

// Launches have no limit if the last superstep was short, because the number of packets in a queue, and so a
// superstep's work, grows by a small factor only. Then the host need not read the status after each launch.
template <class Launch>
void NodeArray::launch_until_done(const std::string& label, const Launch& launch) {
    constexpr double kShort_s = 0.25;
    constexpr std::uint32_t kFirstWork = 1 << 16;
    std::uint32_t work = superstep_s_ && *superstep_s_ < kShort_s ? kUnlimitedWork : kFirstWork;
    if (settings_.work_per_launch > 0) work = settings_.work_per_launch;
    const double target_s = settings_.work_per_launch > 0 ? 0 : 1;
    std::vector<std::uint32_t> status(status_.size());
    const auto launch_part = [&](std::uint32_t part, bool resumes) {
        launch(node_kernels::Work{part}, node_kernels::Resume{resumes});
    };
    const auto end = [&] {
        session_.read(label, status_, status);
        return LaunchEnd{!any_node_has(status, RAYA_STATUS_LEFT), any_node_has(status, RAYA_STATUS_CUT)};
    };
    launches_.run(session_, label, work, target_s, launch_part, end, queues_, ray_links_.outboxes(),
                  ray_links_.inboxes(), return_links_.outboxes(), return_links_.inboxes(), returns_, status_, events_,
                  made_, ended_);
}

void NodeArray::inject() {
    launch_until_done("inject", [&](node_kernels::Work work, node_kernels::Resume resume) {
        session_.launch("inject", inject_, nodes_, options_.group_size, memories_, starts_, run_,
                        node_kernels::FirstNode{0}, work, resume,
                        local_words(RAYA_INJECT_WORDS(options_.group_size, options_.lanes)), queues_, status_, events_,
                        made_, ended_);
    });
}

void NodeArray::trace_voxel(Reserve reserve) {
    launch_until_done("trace_voxel", [&](node_kernels::Work work, node_kernels::Resume resume) {
        session_.launch("trace_voxel", trace_, nodes_, options_.group_size, memories_, starts_, run_,
                        node_kernels::FirstNode{0}, reserve, work, resume, local_words(RAYA_COUNT_WORDS), queues_,
                        status_, events_, made_, ended_, processed_);
    });
}

void NodeArray::route() {
    launch_until_done("route", [&](node_kernels::Work work, node_kernels::Resume resume) {
        session_.launch("route", route_, nodes_, options_.group_size, memories_, starts_, run_,
                        node_kernels::FirstNode{0}, work, resume, local_words(RAYA_ROUTE_WORDS(options_.group_size)),
                        queues_, ray_links_.outboxes(), return_links_.outboxes(), returns_, status_, ended_);
    });
}

void NodeArray::accept(Reserve reserve, std::uint32_t superstep) {
    launch_until_done("accept", [&](node_kernels::Work work, node_kernels::Resume resume) {
        session_.launch(
            "accept", accept_, nodes_, options_.group_size, memories_, starts_, run_, reserve, Uint<"turn">{superstep},
            node_kernels::FirstNode{0}, inbox_of_link_, ray_links_.sent_flags(), return_links_.sent_flags(), work,
            resume, LocalMemory<std::uint32_t>{RAYA_ACCEPT_WORDS(options_.group_size)}, queues_, ray_links_.inboxes(),
            return_links_.inboxes(), return_links_.outboxes(), returns_, status_, ended_);
    });
}

std::vector<std::uint64_t> NodeArray::exchange(const NodeStatus& status) {
    std::vector<OutgoingMessage> out;
    std::vector<IncomingMessage> in;
    if (distribution_.ranks().has_several()) {
        ray_links_.begin_transfers(status, out, in);
        return_links_.begin_transfers(status, out, in);
        distribution_.ranks().start(out, in);
    }
    std::vector<std::uint64_t> words(std::size_t{raya_nodes(settings_.torus)} * RAYA_LINKS);
    ray_links_.exchange(status, words);
    return_links_.exchange(status, words);
    if (distribution_.ranks().has_several()) {
        session_.flush();  // the device computes while the host waits
        distribution_.ranks().wait();
        ray_links_.write_incoming();
        return_links_.write_incoming();
    }
    return words;
}

std::vector<std::uint64_t> NodeArray::link_packets() const {
    std::vector<std::uint64_t> messages = ray_links_.messages();
    for (std::size_t i = 0; i < messages.size(); ++i) messages[i] += return_links_.messages()[i];
    return messages;
}

NodeStatus NodeArray::read_status() {
    std::vector<std::uint32_t> own_status(status_.size());
    session_.read("read status", status_, own_status);
    if (any_node_has(own_status, RAYA_STATUS_CUT))
        throw truncated_loops_error("read status", session_.device().name, launches_.remedy());
    superstep_s_ = seconds_since(std::exchange(last_status_, Clock::now()));
    return {distribution_.all_gather(std::move(own_status), RAYA_STATUS_WORDS)};
}

void NodeArray::report_work(const NodeStatus& injected, const NodeWorkSink& sink) {
    const NodeStatus status = read_status();
    const std::vector<std::uint64_t> cycles = cycles_of_nodes(injected, nodes_);
    std::vector<raya_processed> processed;
    std::vector<raya_packet> queue;
    for (std::uint32_t node = 0; node < nodes_; ++node) {
        processed.resize(injected.at(node, RAYA_STATUS_QUEUE));
        queue.resize(status.at(node, RAYA_STATUS_QUEUE));
        session_.read("history", processed_, processed, std::size_t{node} * buffers_.queue);
        session_.read("history", queues_, queue, std::size_t{node} * buffers_.queue);
        sink({node, cycles[node], processed, queue});
    }
}

void NodeArray::continue_gather(const NodeStatus& status, std::vector<raya_head>& returns) {
    finish_gather(returns);
    if (!distribution_.has(RAYA_ROOT)) return;
    returns_pending_ = status.at(RAYA_ROOT, RAYA_STATUS_HOST);
    session_.read("gather", returns_, 0, returns_readback_, 0, returns_pending_);
}

// Called one superstep after the start of the readback. In between, read_status() has waited for the command queue, so
// the readback is complete.
void NodeArray::finish_gather(std::vector<raya_head>& returns) {
    if (returns_pending_ == 0) return;
    session_.wait("gather", returns_readback_);
    const std::span<const raya_head> read = returns_readback_.first(std::exchange(returns_pending_, 0));
    returns.insert(returns.end(), read.begin(), read.end());
}

NodeArray::Counters NodeArray::read_counters() {
    Counters counters;
    for (const auto& [buffer, values] : {std::pair(&events_, &counters.events), std::pair(&made_, &counters.made),
                                         std::pair(&ended_, &counters.ended)}) {
        values->resize(buffer->size());
        session_.read("read counters", *buffer, *values);
    }
    return counters;
}

void NodeArray::visit_state(RenderState& state, NodeStatus& status) {
    if (state.restores()) clear();
    state.buffer(status_);
    if (state.restores()) status = read_status();
    for (std::uint32_t node = 0; node < distribution_.all(); ++node) {
        bool fits = std::max(status.at(node, RAYA_STATUS_QUEUE), status.at(node, RAYA_STATUS_HOST)) <= buffers_.queue;
        for (const std::uint32_t boxes :
             {RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX, RAYA_STATUS_RETURN_OUTBOX, RAYA_STATUS_RETURN_INBOX})
            for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
                fits &= status.at(node, boxes + link) <= buffers_.box;
        if (!fits) throw UserError("damaged");
    }
    for (Buffer<std::uint64_t>* counters : {&events_, &made_, &ended_}) state.buffer(*counters);
    ray_links_.visit_state(state, status);
    return_links_.visit_state(state, status);
    state.parts(queues_, [&](std::uint32_t node) {
        return std::vector<RenderState::Part>{
            {std::size_t{distribution_.slot_of(node)} * buffers_.queue, status.at(node, RAYA_STATUS_QUEUE)}};
    });
}

std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes) {
    std::vector<std::uint64_t> cycles;
    for (std::uint32_t node = 0; node < nodes; ++node) {
        const std::uint64_t high = status.at(node, RAYA_STATUS_CYCLES + 1);
        cycles.push_back(high << 32 | status.at(node, RAYA_STATUS_CYCLES));
    }
    return cycles;
}

MachineState machine_state(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity) {
    MachineState state{.max_cycles = std::ranges::max(cycles_of_nodes(status, nodes))};
    std::uint64_t rows = 0, injected_rows = 0;
    for (std::uint32_t node = 0; node < nodes; ++node) {
        const auto at = [&](std::uint32_t word) { return status.at(node, word); };
        state.live += at(RAYA_STATUS_QUEUE) + at(RAYA_STATUS_HOST);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            state.live += at(RAYA_STATUS_OUTBOX + link) + at(RAYA_STATUS_INBOX + link) +
                          at(RAYA_STATUS_RETURN_OUTBOX + link) + at(RAYA_STATUS_RETURN_INBOX + link);
        state.longest_queue = std::max(state.longest_queue, at(RAYA_STATUS_QUEUE));
        state.full_queues += at(RAYA_STATUS_QUEUE) >= capacity;
        state.progress += at(RAYA_STATUS_PROGRESS);
        state.all_injected &= at(RAYA_STATUS_NEXT_ROW) >= at(RAYA_STATUS_ROWS);
        rows += at(RAYA_STATUS_ROWS);
        injected_rows += at(RAYA_STATUS_NEXT_ROW);
    }
    state.injected_fraction = rows ? static_cast<double>(injected_rows) / static_cast<double>(rows) : 1;
    return state;
}

double progress_of(const MachineState& state, std::size_t returns, std::uint64_t max_live) {
    const auto finished_packets = static_cast<double>(returns), live_packets = static_cast<double>(state.live);
    if (live_packets == 0) return state.injected_fraction;
    const double decrease = 1 - std::log1p(live_packets) / std::log1p(static_cast<double>(max_live));
    return state.injected_fraction * (finished_packets / (finished_packets + live_packets) + decrease) / 2;
}

void NodeArray::record_packets(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink) {
    std::vector<PacketRecord> own_records;
    const auto record_new = [&](std::uint32_t node, const raya_head& packet) {
        const bool is_return = raya_state_kind(packet.state) == RAYA_KIND_RETURN;
        if (!(packet.state & RAYA_STATE_FRESH) || (is_return && !(packet.state & RAYA_STATE_CHARGED))) return;
        own_records.push_back({superstep, node, destination_of(settings_.torus, node, packet), packet,
                               is_return ? settings_.packets.return_words() : settings_.packets.ray_words});
    };
    ray_links_.visit_new_packets(status, record_new);
    return_links_.visit_new_packets(status, record_new);
    std::vector<PacketRecord> records = distribution_.ranks().gather(
        std::span<const PacketRecord>(own_records), distribution_.ranks().all_gather(own_records.size()));
    std::ranges::stable_sort(records, {}, &PacketRecord::source);
    for (const PacketRecord& record : records) sink(record);
}

}  // namespace raya
