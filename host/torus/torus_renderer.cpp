#include "host/torus/torus_renderer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "host/array/checkpoints.hpp"
#include "host/array/render.hpp"
#include "host/base/log.hpp"
#include "host/error.hpp"
#include "host/torus/node_array.hpp"
#include "host/torus/torus_plan.hpp"

namespace raya {

// Maximum number of returns for which render() reserves memory in advance: 128 MB of address space. The operating
// system allocates a page only when it is used.
constexpr std::uint64_t kReservedReturns = 1 << 22;

namespace {

// Returns the sums of counts of several nodes, [node][count].
template <class Counts>
Counts sums_of(const std::vector<std::uint64_t>& of_nodes) {
    Counts sums{};
    for (std::size_t i = 0; i < of_nodes.size(); ++i) sums[i % sums.size()] += of_nodes[i];
    return sums;
}

}  // namespace

TorusRenderer::TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings, Ranks& ranks,
                             const std::function<void()>& packed)
    : session_(session),
      ranks_(ranks),
      settings_(checked_settings(settings, scene, session.device())),
      scene_name_(scene.name),
      distribution_(settings_.torus, ranks),
      job_(make_torus_job(session, scene, settings_, distribution_, packed)) {
    ranks.one_rank_per_host_first([this] { build(); });
}

void TorusRenderer::set_queue(std::uint32_t queue) {
    job_.buffers = buffers_for(queue);
    build();
}

void TorusRenderer::build() {
    const std::uint64_t packets = std::max<std::uint64_t>(job_.buffers.queue, RAYA_LINKS * (job_.buffers.box + 1ull));
    if (packets * sizeof(raya_packet) * distribution_.count() > session_.device().max_allocation_bytes)
        throw UserError(
            fmt::format("{}: the queues or mailboxes of {} nodes exceed the maximum buffer of {}; use a "
                        "shorter --queue than {} or fewer nodes",
                        scene_name_, distribution_.count(), session_.device().name, job_.buffers.queue));
    const SpanLog::Span span = session_.span("set up device");
    const std::jthread notice = session_.compile_notice();
    const Clock::time_point start = Clock::now();
    KernelOptions options = kernel_options(settings_, job_.header, job_.has_patches);
    options.costs = settings_.history;
    nodes_ = std::make_unique<NodeArray>(session_, settings_, job_.memories, job_.buffers, options, distribution_);
    options.lanes = 1;
    compose_ = Kernels(session_, options, settings_.kernels.sources).get<ComposeKernel>();
    sum({{0, 0, 0, 0}, {0, 1}});
    nodes_->clear();
    // Launches the kernels once, with empty queues, because PoCL compiles a kernel at its first launch.
    nodes_->trace_voxel(Reserve::kWholeTree);
    nodes_->route();
    nodes_->accept(Reserve::kWholeTree, 0);
    session_.finish();
    build_s_ = seconds_since(start);
}

TorusResult TorusRenderer::render(const ProgressCallback& progress, const RenderObservers& observers,
                                  const Checkpointing* checkpointing) {
    if (observers.work && !settings_.history)
        throw std::logic_error("an observer of work needs TorusSettings::history");
    if (checkpointing != nullptr && (observers.work || observers.packets || observers.supersteps))
        throw std::logic_error("a render with observers cannot save checkpoints");
    session_.clear_profile();
    const SpanLog::Span rendering = session_.span("render");
    const RankTraffic traffic_before = ranks_.traffic();
    TorusRun run;
    run.returns.reserve(std::min<std::uint64_t>(2 * traced_pixels(settings_), kReservedReturns));
    RenderObservers own_observers = observers;
    if (!ranks_.is_first()) own_observers.supersteps = {};
    Checkpoints checkpoints(checkpointing, session_, distribution_,
                            checkpointing ? state_settings(settings_, job_, distribution_) : StateSettings{});
    run_supersteps(run, checkpoints, progress, own_observers);
    TorusResult& result = run.result;
    if (ranks_.is_first()) compose(result, run.returns);
    collect(result);
    result.earlier_s = checkpoints.earlier_s();
    result.render_s = checkpoints.seconds();
    result.traffic = ranks_.traffic() - traffic_before;
    describe(result);
    if (ranks_.is_first()) check(result);
    return std::move(result);
}

// Computes a superstep up to the transfer of packets, and starts to read the returns. Returns the status of all nodes.
NodeStatus TorusRenderer::compute(TorusRun& run, bool injects, const RenderObservers& observers) {
    if (injects) nodes_->inject();
    const NodeStatus injected = observers.work ? nodes_->read_status() : NodeStatus{};
    nodes_->trace_voxel(run.reserve);
    if (observers.work) nodes_->report_work(injected, observers.work);
    nodes_->route();
    const NodeStatus status = nodes_->read_status();
    nodes_->continue_gather(status, run.returns);
    if (observers.packets) nodes_->record_packets(status, run.superstep, observers.packets);
    return status;
}

// Adds the counts of a superstep to the run, and passes them to `sink`. `words`: [node][RAYA_LINKS], number of words
// charged for each link.
void TorusRenderer::add_superstep(TorusRun& run, const NodeStatus& status, const MachineState& state,
                                  const std::vector<std::uint64_t>& words, const SuperstepSink& sink) const {
    run.result.supersteps.push_back({state.max_cycles, *std::max_element(words.begin(), words.end()), state.live});
    if (sink) sink({run.result.supersteps.back(), cycles_of_nodes(status, raya_nodes(settings_.torus)), words});
    for (std::size_t i = 0; i < words.size(); ++i) run.result.link_words[i] += words[i];
}

// Runs supersteps until the image is complete. All ranks read the status of all nodes_, so they make the same
// decisions.
void TorusRenderer::run_supersteps(TorusRun& run, Checkpoints& checkpoints, const ProgressCallback& progress,
                                   const RenderObservers& observers) {
    const SpanLog::Span span = session_.span("supersteps");
    const std::uint32_t all_nodes = raya_nodes(settings_.torus), queue = job_.buffers.queue;
    nodes_->clear();
    run.result.link_words.assign(std::size_t{all_nodes} * RAYA_LINKS, 0);
    NodeStatus status;
    const auto visit = [&](RenderState& state) { visit_state(state, run, status); };
    bool resumes = checkpoints.resume(visit), injects = true;
    for (;; ++run.superstep, resumes = false) {
        if (!resumes) status = compute(run, injects, observers);
        const MachineState state = machine_state(status, all_nodes, queue);
        run.max_live = std::max(run.max_live, state.live);
        if (!resumes) checkpoints.save_if_due(progress_of(state, run.returns.size(), run.max_live), visit);
        const std::vector<std::uint64_t> words = nodes_->exchange(status);
        nodes_->accept(run.reserve, run.superstep);

        add_superstep(run, status, state, words, observers.supersteps);
        const bool ended = state.live == status.at(RAYA_ROOT, RAYA_STATUS_HOST) && state.all_injected;
        if (progress) progress(ended ? 1 : progress_of(state, run.returns.size(), run.max_live));
        if (ended) return nodes_->finish_gather(run.returns);
        injects = !state.all_injected && state.longest_queue <= queue / 4;
        // Packets that a superstep accepts with a tight reserve count as progress only in the next superstep. So only
        // three supersteps without progress prove a deadlock.
        run.stalled = state.progress == 0 && run.result.supersteps.back().max_link_words == 0 ? run.stalled + 1 : 0;
        if (run.stalled == 3)
            throw TorusDeadlock(
                fmt::format("{}: deadlock in superstep {}: {} packets wait for each other, {} of {} "
                            "queues are full at {} packets; use a longer queue",
                            scene_name_, run.superstep, state.live, state.full_queues, all_nodes, queue),
                queue);
        run.reserve = run.stalled > 0 ? Reserve::kTight : Reserve::kWholeTree;
    }
}

// Saves or restores the state between routing and the transfer of packets.
void TorusRenderer::visit_state(RenderState& state, TorusRun& run, NodeStatus& status) {
    if (!state.restores()) nodes_->finish_gather(run.returns);
    for (std::uint32_t* number : {&run.superstep, &run.stalled}) state.value(*number);
    state.value(run.reserve);
    state.value(run.max_live);
    state.rank_0(run.result.supersteps, true);
    state.rank_0(run.result.link_words);
    state.rank_0(run.returns, true);
    if (ranks_.is_first() &&
        (run.result.supersteps.size() != run.superstep || run.stalled > 2 || run.reserve > Reserve::kTight))
        throw UserError("damaged");
    nodes_->visit_state(state, status);
}

void TorusRenderer::compose(TorusResult& result, const std::vector<raya_head>& returns) {
    const SpanLog::Span span = session_.span("compose");
    result.contributions = returns.size();
    for (const raya_head& packet : returns) result.returns += (packet.state & RAYA_STATE_CHARGED) != 0;
    const std::uint32_t pixels = settings_.width * settings_.height;
    result.image = {static_cast<int>(settings_.width), static_cast<int>(settings_.height),
                    sum(sort_contributions(returns, pixels))};
}

void TorusRenderer::collect(TorusResult& result) {
    const SpanLog::Span span = session_.span("collect");
    const NodeArray::Counters own = nodes_->read_counters();
    result.rank_events = sums_of<EventCounts>(own.events);
    result.rank_made = sums_of<PacketCounts>(own.made);
    const std::vector<std::uint64_t> events = distribution_.gather(own.events, RAYA_EVENTS);
    result.events = sums_of<EventCounts>(events);
    result.made = sums_of<PacketCounts>(distribution_.gather(own.made, RAYA_KINDS));
    result.ended = sums_of<PacketCounts>(distribution_.gather(own.ended, RAYA_KINDS));
    const auto cycles = t805_cycles(settings_.packets);
    std::vector<std::uint64_t> loads(raya_nodes(settings_.torus));
    for (std::size_t i = 0; i < events.size(); ++i) loads[i / RAYA_EVENTS] += cycles[i % RAYA_EVENTS] * events[i];
    if (ranks_.is_first()) result.load = load_of(std::move(loads));
    const NodeStatus status = nodes_->read_status();
    for (std::uint32_t node = 0; node < raya_nodes(settings_.torus); ++node)
        result.queue_max = std::max<std::uint64_t>(result.queue_max, status.at(node, RAYA_STATUS_QUEUE_MAX));
    result.link_packets = nodes_->link_packets();
    for (const std::uint64_t packets : result.link_packets) result.hops += packets;
    result.sent_rays = nodes_->ray_links().sent_packets();
    result.received_rays = nodes_->ray_links().received_packets();
    result.received_returns = nodes_->return_links().received_packets();
}

// Throws std::logic_error if a packet was lost or duplicated, because the image would be wrong.
void TorusRenderer::check(const TorusResult& result) const {
    for (std::size_t kind = 1; kind < RAYA_KINDS; ++kind)
        if (result.made[kind] != result.ended[kind])
            throw std::logic_error(
                fmt::format("{} packets of kind {} were made, {} ended", result.made[kind], kind, result.ended[kind]));
    if (result.made[RAYA_KIND_PRIMARY] != traced_pixels(settings_))
        throw std::logic_error(
            fmt::format("{} primary rays for {} pixels", result.made[RAYA_KIND_PRIMARY], traced_pixels(settings_)));
    const EventCounts& e = result.events;
    const std::uint64_t expected_returns = settings_.packets.one_return_per_ray
                                               ? e[RAYA_PRIMARY] + e[RAYA_REFLECTED] + e[RAYA_REFRACTED]
                                               : result.made[RAYA_KIND_RETURN];
    if (result.returns != expected_returns)
        throw std::logic_error(
            fmt::format("{} returns are charged as messages, expected {}", result.returns, expected_returns));
}

void TorusRenderer::describe(TorusResult& result) const {
    result.copies = job_.copies;
    result.scale = job_.scale;
    result.buffers = job_.buffers;
    result.copied_words = nodes_->copies_words_to_local() ? job_.memories.words.size() : 0;
    result.node_bytes = node_bytes(job_.fullest_words, job_.buffers, links_of_node(settings_.torus));
    result.parts_of_rank = distribution_.count();
    result.lanes = settings_.kernels.lanes;
    result.group_size = settings_.kernels.group_size;
    result.build_options = nodes_->build_options();
    result.tuned = settings_.kernels.origin;
    result.build_s = build_s_;
    result.commands = session_.profile().summary();
}

namespace {

bool comes_before(const raya_head& a, const raya_head& b) {
    return raya_comes_before(a.path, a.state, b.path, b.state);
}

}  // namespace

Contributions sort_contributions(const std::vector<raya_head>& returns, std::uint32_t pixels) {
    if (returns.size() > std::numeric_limits<std::uint32_t>::max())
        throw UserError("more than 2^32 contributions to one image; render fewer pixels or with fewer --bounces");
    Contributions sorted;
    sorted.starts.assign(std::size_t{pixels} + 1, 0);
    for (const raya_head& packet : returns) {
        if (packet.pixel >= pixels)
            throw std::logic_error(
                fmt::format("a contribution has pixel {}, but the image has only {} pixels", packet.pixel, pixels));
        ++sorted.starts[packet.pixel + 1];
    }
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) sorted.starts[pixel + 1] += sorted.starts[pixel];
    std::vector<std::uint32_t> next(sorted.starts.begin(), sorted.starts.end() - 1), order(returns.size());
    for (std::uint32_t i = 0; i < returns.size(); ++i) order[next[returns[i].pixel]++] = i;

    sorted.colours.reserve(4 * returns.size());
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        const auto first = order.begin() + sorted.starts[pixel], last = order.begin() + sorted.starts[pixel + 1];
        std::sort(first, last, [&](std::uint32_t a, std::uint32_t b) { return comes_before(returns[a], returns[b]); });
        for (auto i = first; i != last; ++i) {
            if (i != first && !comes_before(returns[i[-1]], returns[*i]))
                throw std::logic_error(fmt::format("pixel {}: two contributions of the same ray", pixel));
            const raya_head& packet = returns[*i];
            sorted.colours.insert(sorted.colours.end(), std::begin(packet.carries.colour),
                                  std::end(packet.carries.colour));
            sorted.colours.push_back(packet.weight);
        }
    }
    return sorted;
}

// Sums the contributions of each pixel on the device. Returns [pixel][3]: linear red, green and blue, rounded to the
// number format.
std::vector<float> TorusRenderer::sum(const Contributions& contributions) {
    const std::uint32_t group_size = settings_.kernels.group_size;
    const auto pixels = static_cast<std::uint32_t>(contributions.starts.size() - 1);
    Buffer<float> colours =
        session_.buffer<float>("contributions", std::max<std::size_t>(4, contributions.colours.size()));
    Buffer<std::uint32_t> starts =
        session_.buffer<std::uint32_t>("starts of contributions", contributions.starts.size());
    Buffer<float> image = session_.buffer<float>("image", 3ull * pixels);
    Buffer<std::uint32_t> cut_flag = session_.buffer<std::uint32_t>("loops cut", 1);
    session_.write("compose", colours, contributions.colours);
    session_.write("compose", starts, contributions.starts);
    constexpr std::size_t kPixelsPerItem = 16, kMaxGroups = 4096;
    std::uint32_t was_cut = 1;
    for (std::size_t groups = std::min(kMaxGroups, pixels / (kPixelsPerItem * group_size) + 1); was_cut; groups *= 2) {
        session_.fill("compose", cut_flag, 0);
        session_.launch("compose", *compose_, groups, group_size, colours, starts, Uint<"pixels">{pixels}, image,
                        cut_flag);
        session_.read("compose", cut_flag, {&was_cut, 1});
        if (was_cut && groups * group_size >= pixels)
            throw truncated_loops_error("compose", session_.device().name, "fewer --bounces");
    }
    std::vector<float> pixels_of_image(3ull * pixels);
    session_.read("compose", image, pixels_of_image);
    return pixels_of_image;
}

}  // namespace raya
