#include "host/torus/torus_renderer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "host/array/checkpoints.hpp"
#include "host/array/render.hpp"
#include "host/base/log.hpp"
#include "host/error.hpp"
#include "host/torus/node_array.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/torus_plan.hpp"

namespace raya {

// Maximum number of returns for which render() reserves memory in advance: 128 MB of address space. The operating
// system allocates a page only when it is used.
constexpr std::uint64_t kReservedReturns = 1 << 22;

struct TorusRenderer::Impl {
    Session& session;
    Ranks& ranks;
    TorusSettings settings;
    std::string scene_name;
    NodeDistribution distribution;
    DeviceMemory device_memory;  // minimum over all ranks
    TorusJob job;
    KernelOptions options;
    std::unique_ptr<NodeArray> nodes{};
    std::unique_ptr<Composer> composer{};
    double build_s = 0;

    void build();
    std::optional<DeadlockFigures> run_supersteps(TorusRun& run, Checkpoints& checkpoints,
                                                  const ProgressCallback& progress, const RenderObservers& observers);
    void add_superstep(TorusRun& run, const NodeStatus& status, const MachineState& state,
                       const std::vector<std::uint64_t>& words, const SuperstepSink& sink) const;
    NodeStatus route(TorusRun& run, const RenderObservers& observers);
    void compute(NodeArray::Slots slots, Reserve reserve, bool injects, const NodeWorkSink& work);
    void compose(TorusResult& result, const std::vector<raya_head>& returns);
    void collect(TorusResult& result);
    void check(const TorusResult& result) const;
    void describe(TorusResult& result) const;
    void visit_state(RenderState& state, TorusRun& run, NodeStatus& status);
};

TorusRenderer::TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings, Ranks& ranks,
                             const std::function<void()>& packed) {
    const TorusSettings chosen = checked_settings(settings, scene, session.device());
    const NodeDistribution distribution(chosen.torus, ranks);
    const DeviceMemory device_memory = smallest_device_memory(session.device(), ranks);
    TorusJob job = make_torus_job(session, scene, chosen, distribution, device_memory, ranks, packed);
    KernelOptions options = kernel_options(chosen, job.header_only);
    options.costs = chosen.history;
    impl_.reset(new Impl{.session = session,
                         .ranks = ranks,
                         .settings = chosen,
                         .scene_name = scene.name,
                         .distribution = distribution,
                         .device_memory = device_memory,
                         .job = std::move(job),
                         .options = options});
    ranks.one_rank_per_host_first([this] { impl_->build(); });
}

TorusRenderer::~TorusRenderer() = default;

const LengthScale& TorusRenderer::scale() const { return impl_->job.scale; }

void TorusRenderer::set_pixels(const PixelSubset& pixels) {
    impl_->settings.pixels = pixels;
    impl_->nodes->set_pixels(pixels);
}

void TorusRenderer::set_queue(std::uint32_t queue) {
    Impl& p = *impl_;
    const NodeBuffers buffers = buffers_for(queue);
    check_device_memory(p.scene_name, buffers, p.distribution.max_count(), p.session.device().name, p.device_memory);
    p.job.buffers = buffers;
    p.build();
}

void TorusRenderer::Impl::build() {
    const SpanLog::Span span = session.span("set up device");
    const std::jthread notice = session.compile_notice();
    const Clock::time_point start = Clock::now();
    nodes = std::make_unique<NodeArray>(session, settings, job.memories, job.buffers, options, distribution, ranks);
    KernelOptions one_lane = options;
    one_lane.lanes = 1;
    Kernels kernels(session, one_lane, settings.kernels.sources);
    composer = std::make_unique<Composer>(kernels);
    nodes->clear();
    // Launches the kernels once with empty queues, because PoCL compiles a kernel at its first launch.
    nodes->trace_voxel(nodes->all(), Reserve::kWholeTree);
    nodes->route();
    nodes->accept(nodes->all(), Reserve::kWholeTree, 0);
    session.finish();
    build_s = seconds_since(start);
}

TorusResult TorusRenderer::render(const ProgressCallback& progress, const RenderObservers& observers,
                                  const Checkpointing* checkpointing) {
    Impl& p = *impl_;
    if (observers.work && !p.settings.history)
        throw std::logic_error("an observer of work needs TorusSettings::history");
    if (checkpointing != nullptr && (observers.work || observers.packets || observers.supersteps))
        throw std::logic_error("a render with observers cannot save checkpoints");
    p.session.clear_profile();
    const SpanLog::Span rendering = p.session.span("render");
    const RankTraffic traffic_before = p.ranks.traffic();
    TorusRun run;
    run.returns.reserve(std::min<std::uint64_t>(2 * traced_pixels(p.settings), kReservedReturns));
    RenderObservers own_observers = observers;
    if (!p.ranks.is_first()) own_observers.supersteps = {};
    Checkpoints checkpoints(checkpointing, p.session, p.distribution,
                            checkpointing ? state_settings(p.settings, p.job, p.distribution) : StateSettings{});
    if (const auto deadlock = p.run_supersteps(run, checkpoints, progress, own_observers))
        throw TorusDeadlock(*deadlock);
    TorusResult result;
    if (p.ranks.is_first()) p.compose(result, run.returns);
    result.supersteps = std::move(run.supersteps);
    result.link_words = std::move(run.link_words);
    p.collect(result);
    result.earlier_s = checkpoints.earlier_s();
    result.render_s = checkpoints.seconds();
    result.traffic = p.ranks.traffic() - traffic_before;
    p.describe(result);
    if (p.ranks.is_first()) p.check(result);
    return result;
}

// Launches the computation of a superstep, which precedes the transfer of packets.
void TorusRenderer::Impl::compute(NodeArray::Slots slots, Reserve reserve, bool injects, const NodeWorkSink& work) {
    if (injects) nodes->inject(slots);
    if (!work) return nodes->trace_voxel(slots, reserve);
    const NodeStatus injected = nodes->read_status();
    nodes->trace_voxel(slots, reserve);
    nodes->report_work(injected, work);
}

// Adds the counts of a superstep to the run, and passes them to `sink`. `words`: [node][RAYA_LINKS], number of words
// charged for each link.
void TorusRenderer::Impl::add_superstep(TorusRun& run, const NodeStatus& status, const MachineState& state,
                                        const std::vector<std::uint64_t>& words, const SuperstepSink& sink) const {
    run.supersteps.push_back({state.max_cycles, *std::max_element(words.begin(), words.end()), state.live});
    if (sink) sink({run.supersteps.back(), cycles_of_nodes(status, raya_nodes(settings.torus)), words});
    for (std::size_t i = 0; i < words.size(); ++i) run.link_words[i] += words[i];
}

// Runs supersteps until the image is complete; on a deadlock, returns the state of the machine. All ranks read the
// status of all nodes, so they make the same decisions. While packets are transferred between ranks, the inner nodes
// compute the next superstep.
std::optional<DeadlockFigures> TorusRenderer::Impl::run_supersteps(TorusRun& run, Checkpoints& checkpoints,
                                                                   const ProgressCallback& progress,
                                                                   const RenderObservers& observers) {
    const SpanLog::Span span = session.span("supersteps");
    nodes->clear();
    run.link_words.assign(std::size_t{raya_nodes(settings.torus)} * RAYA_LINKS, 0);
    NodeStatus status(0);
    const auto visit = [&](RenderState& state) { visit_state(state, run, status); };
    bool resumes = checkpoints.resume(visit);
    if (!resumes) compute(nodes->all(), run.reserve, true, observers.work);
    for (;; ++run.superstep, resumes = false) {
        if (!resumes) status = route(run, observers);
        const MachineState state = machine_state(status, raya_nodes(settings.torus), job.buffers.queue);
        run.max_live = std::max(run.max_live, state.live);
        if (!resumes) checkpoints.save_if_due(progress_of(state, run.returns.size(), run.max_live), visit);
        const std::vector<std::uint64_t> words = nodes->exchange(status);
        nodes->accept(nodes->inner(), run.reserve, run.superstep);

        add_superstep(run, status, state, words, observers.supersteps);
        const bool ended = state.live == status.at(RAYA_ROOT, RAYA_STATUS_HOST) && state.all_injected;
        if (progress) progress(ended ? 1 : progress_of(state, run.returns.size(), run.max_live));
        const bool injects = !state.all_injected && state.longest_queue <= job.buffers.queue / 4;
        // Packets that a superstep accepts with a tight reserve count as progress only in the next superstep. So only
        // three supersteps without progress prove a deadlock.
        run.stalled = state.progress == 0 && run.supersteps.back().max_link_words == 0 ? run.stalled + 1 : 0;
        const Reserve next_reserve = run.stalled > 0 ? Reserve::kTight : Reserve::kWholeTree;
        const bool continues = !ended && run.stalled < 3;
        if (continues && nodes->inner().count > 0) compute(nodes->inner(), next_reserve, injects, observers.work);
        nodes->finish_exchange();
        nodes->accept(nodes->border(), run.reserve, run.superstep);
        if (ended) {
            nodes->finish_gather(run.returns);
            return {};
        }
        if (!continues)
            return DeadlockFigures{
                scene_name,       run.superstep, state.live, state.full_queues, raya_nodes(settings.torus),
                job.buffers.queue};
        if (nodes->border().count > 0) compute(nodes->border(), next_reserve, injects, observers.work);
        run.reserve = next_reserve;
    }
}

// Saves or restores the state between routing and the transfer of packets.
void TorusRenderer::Impl::visit_state(RenderState& state, TorusRun& run, NodeStatus& status) {
    if (!state.restores()) nodes->finish_gather(run.returns);
    for (std::uint32_t* number : {&run.superstep, &run.stalled}) state.value(*number);
    state.value(run.reserve);
    state.value(run.max_live);
    state.rank_0(run.supersteps, true);
    state.rank_0(run.link_words);
    state.rank_0(run.returns, true);
    if (ranks.is_first() &&
        (run.supersteps.size() != run.superstep || run.stalled > 2 || run.reserve > Reserve::kTight))
        throw UserError("damaged");
    nodes->visit_state(state, status);
}

// Moves packets from the queues to the outboxes, and starts to read the returns. Returns the status of all nodes.
NodeStatus TorusRenderer::Impl::route(TorusRun& run, const RenderObservers& observers) {
    nodes->route();
    const NodeStatus status = nodes->read_status();
    nodes->continue_gather(status, run.returns);
    if (observers.packets)
        nodes->record_packets(status, run.superstep,
                              run.superstep % observers.packets_every ? PacketSink{} : observers.packets);
    return status;
}

void TorusRenderer::Impl::compose(TorusResult& result, const std::vector<raya_head>& returns) {
    const SpanLog::Span span = session.span("compose");
    result.contributions = returns.size();
    for (const raya_head& packet : returns) result.returns += (packet.state & RAYA_STATE_CHARGED) != 0;
    const std::uint32_t pixels = settings.width * settings.height;
    result.image = {static_cast<int>(settings.width), static_cast<int>(settings.height),
                    composer->compose(sort_contributions(returns, pixels))};
}

void TorusRenderer::Impl::collect(TorusResult& result) {
    const SpanLog::Span span = session.span("collect");
    const std::vector<std::uint64_t> events = nodes->read_events();
    const auto cycles = t805_cycles(settings.packets);
    std::vector<std::uint64_t> loads(raya_nodes(settings.torus));
    for (std::size_t i = 0; i < events.size(); ++i) {
        result.events[i % RAYA_EVENTS] += events[i];
        loads[i / RAYA_EVENTS] += cycles[i % RAYA_EVENTS] * events[i];
    }
    if (ranks.is_first()) result.load = load_of(std::move(loads));
    result.rank_events = nodes->read_own_events();
    std::tie(result.made, result.rank_made) = nodes->read_created_counts();
    result.ended = nodes->read_ended_counts();
    const NodeStatus status = nodes->read_status();
    for (std::uint32_t node = 0; node < raya_nodes(settings.torus); ++node)
        result.queue_max = std::max<std::uint64_t>(result.queue_max, status.at(node, RAYA_STATUS_QUEUE_MAX));
    result.link_packets = nodes->link_packets();
    for (const std::uint64_t packets : result.link_packets) result.hops += packets;
    result.sent_rays = nodes->ray_links().sent_packets();
    result.received_rays = nodes->ray_links().received_packets();
    result.received_returns = nodes->return_links().received_packets();
}

// Throws std::logic_error if a packet was lost or duplicated, because the image would be wrong.
void TorusRenderer::Impl::check(const TorusResult& result) const {
    for (std::size_t kind = 1; kind < RAYA_KINDS; ++kind)
        if (result.made[kind] != result.ended[kind])
            throw std::logic_error(
                fmt::format("{} packets of kind {} were made, {} ended", result.made[kind], kind, result.ended[kind]));
    if (result.made[RAYA_KIND_PRIMARY] != traced_pixels(settings))
        throw std::logic_error(
            fmt::format("{} primary rays for {} pixels", result.made[RAYA_KIND_PRIMARY], traced_pixels(settings)));
    const EventCounts& e = result.events;
    const std::uint64_t expected_returns = settings.packets.one_return_per_ray
                                               ? e[RAYA_PRIMARY] + e[RAYA_REFLECTED] + e[RAYA_REFRACTED]
                                               : result.made[RAYA_KIND_RETURN];
    if (result.returns != expected_returns)
        throw std::logic_error(
            fmt::format("{} returns are charged as messages, expected {}", result.returns, expected_returns));
}

void TorusRenderer::Impl::describe(TorusResult& result) const {
    result.copies = job.copies;
    result.scale = job.scale;
    result.buffers = job.buffers;
    result.copied_words = nodes->copies_words_to_local() ? job.memories.words.size() : 0;
    result.node_bytes = node_bytes(job.fullest_words, job.buffers, links_of_node(settings.torus));
    result.parts_of_rank = distribution.count();
    result.lanes = settings.kernels.lanes;
    result.group_size = settings.kernels.group_size;
    result.build_options = nodes->build_options();
    result.tuned = settings.kernels.origin;
    result.build_s = build_s;
    result.commands = session.profile().summary();
}

namespace {

bool comes_before(const raya_head& a, const raya_head& b) {
    return raya_comes_before(a.path, a.state, b.path, b.state);
}

void append_contribution(std::vector<float>& colours, const raya_head& packet) {
    colours.insert(colours.end(), std::begin(packet.carries.colour), std::end(packet.carries.colour));
    colours.push_back(packet.weight);
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
            append_contribution(sorted.colours, returns[*i]);
        }
    }
    return sorted;
}

Composer::Composer(Kernels& kernels)
    : session_(kernels.session()), group_size_(kernels.options().group_size), compose_(kernels.get<ComposeKernel>()) {
    compose({{0, 0, 0, 0}, {0, 1}});  // compiles the kernel, because PoCL does so at the first launch
}

std::vector<float> Composer::compose(const Contributions& contributions) {
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
    for (std::size_t groups = std::min(kMaxGroups, pixels / (kPixelsPerItem * group_size_) + 1); was_cut; groups *= 2) {
        session_.fill("compose", cut_flag, 0);
        session_.launch("compose", compose_, groups, group_size_, colours, starts, Uint<"pixels">{pixels}, image,
                        cut_flag);
        session_.read("compose", cut_flag, {&was_cut, 1});
        if (was_cut && groups * group_size_ >= pixels)
            throw truncated_loops_error("compose", session_.device().name, "fewer --bounces");
    }
    std::vector<float> pixels_of_image(3ull * pixels);
    session_.read("compose", image, pixels_of_image);
    return pixels_of_image;
}

}  // namespace raya
