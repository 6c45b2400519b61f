#include "host/ring/ring_renderer.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/base/clock.hpp"
#include "host/error.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/schedule.hpp"

namespace raya {
namespace {

// Returns the number of pixels of each PE that the device holds at a time. For large images the device holds only a
// part (a window) of each PE's block, to save memory on device and host. Anti-aliasing needs all pixels on the device.
// The number does not depend on the number of ranks, so that a checkpoint can be resumed with other ranks.
std::uint32_t device_window(const PeMemory& memory, const RingSettings& settings) {
    if (settings.antialias.method != AntialiasMethod::kNone) return memory.block_pixels;
    const std::uint64_t max_pixels = std::max<std::uint64_t>(1, settings.device_pixels / settings.mapping.pes);
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(memory.block_pixels, max_pixels));
}

}  // namespace

RingRenderer::RingRenderer(Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks,
                           const std::function<void()>& packed)
    : session_(session),
      ranks_(ranks),
      settings_(checked_settings(settings, session.device())),
      pes_(Distribution(settings_.mapping.pes, ranks)),
      job_(make_ring_job(session, scene, settings_, ranks, packed)),
      share_pixels_(largest_share(settings_.mapping)),
      memory_(plan_pe_memory(settings_.machine, pe_demand(settings_, scene.name, job_.job.words().size()))),
      window_(device_window(memory_, settings_)),
      bus_(session, communication_, pes_),
      broadcast_(session.buffer_of("broadcast words", std::span(job_.job.words()))),
      pixels_(session.buffer<float>("pixel blocks", 3ull * pes_.count() * window_)),
      no_marks_(session.buffer<std::uint8_t>("no marks", 1)) {
    ranks_.one_rank_per_host_first([this] { build(); });
}

void RingRenderer::build() {
    const SpanLog::Span building = session_.span("set up device");
    const std::jthread notice = session_.compile_notice();
    const Clock::time_point start = Clock::now();
    const KernelOptions options = kernel_options(settings_, job_.job, job_.accel, session_.device());
    Kernels kernels(session_, options, settings_.kernels.sources);
    tracer_ =
        std::make_unique<Tracer>(kernels, pes_, window_, launch_work(settings_, options, job_.objects, pes_.count()));
    counters_.push_back(tracer_->make_counters(kTracePass));
    bus_.broadcast(broadcast_, job_.job.words());
    tracer_->clear(counters_.front());
    tracer_->warm_up(broadcast_, no_marks_, pixels_, counters_.front());
    if (settings_.antialias.method != AntialiasMethod::kNone) build_exchange(options);
    session_.finish();
    build_s_ = seconds_since(start);
}

void RingRenderer::build_exchange(KernelOptions options) {
    options.lanes = 1;
    Kernels kernels(session_, options, settings_.kernels.sources);
    const ExchangeSetup setup{.session = session_,
                              .broadcast = broadcast_,
                              .pes = pes_,
                              .capacity = memory_.block_pixels,
                              .group_size = options.group_size};
    exchange_ = std::make_unique<NeighbourExchange>(session_, communication_, settings_.mapping, memory_.block_pixels,
                                                    memory_.band_pixels, settings_.antialias.exchange, pes_);
    if (settings_.antialias.method == AntialiasMethod::kFilter) {
        filter_ = std::make_unique<RingFilter>(kernels, setup);
        return;
    }
    contrast_ = std::make_unique<RingContrast>(kernels, setup,
                                               round_to_format(settings_.antialias.threshold, settings_.format));
    counters_.push_back(tracer_->make_counters(kSupersamplePass));
}

RingResult RingRenderer::render(const ProgressCallback& progress, const Checkpointing* checkpointing) {
    session_.clear_profile();
    communication_ = {};
    const SpanLog::Span rendering = session_.span("render");
    checkpoints_.emplace(checkpointing, session_, pes_, checkpointing ? state_settings() : StateSettings{});
    const RankTraffic traffic_before = ranks_.traffic();
    RingResult result;
    prepare(result);
    bus_.broadcast(broadcast_, job_.job.words());
    if (checkpointing) resume(result);
    for (std::uint32_t block_begin = 0; block_begin < share_pixels_; block_begin += memory_.block_pixels)
        render_block(block_begin, result, progress);
    place_gathered_pixels(result);
    if (contrast_) collect_marks(result);
    collect_events(result);
    if (settings_.dynamic && ranks_.is_first()) simulate_schedule(result);
    result.render_s = checkpoints_->seconds();
    result.earlier_s = checkpoints_->earlier_s();
    result.traffic = ranks_.traffic() - traffic_before;
    gathered_ = {};
    describe(result);
    return result;
}

// Renders one block (the pixels of a share that fit the PE's memory at a time), one device window after another.
void RingRenderer::render_block(std::uint32_t block_begin, RingResult& result, const ProgressCallback& progress) {
    const std::uint32_t end = std::min(share_pixels_, block_begin + memory_.block_pixels);
    if (resumed_ && position_.window >= end) return;
    if (!resumed_) bus_.begin_gather();
    for (std::uint32_t window_begin = block_begin; window_begin < end; window_begin += window_) {
        if (resumed_ && position_.window > window_begin) continue;
        const PixelRange range{window_begin, window_begin, std::min(end, window_begin + window_)};
        trace(range, result, progress);
        if (filter_) filter_->apply(pixels_, *exchange_);
        if (contrast_) supersample(result, progress);
        gather(range);
        collect_costs(range, result);
        resumed_ = false;
    }
}

void RingRenderer::prepare(RingResult& result) {
    const SpanLog::Span span = session_.span("prepare");
    const std::size_t pixels = std::size_t{settings_.mapping.width} * settings_.mapping.height;
    std::optional<CostImage> empty_costs;
    if (records_costs() && ranks_.is_first())
        empty_costs = CostImage{settings_.mapping.width, settings_.mapping.height, std::vector<std::uint64_t>(pixels)};
    if (counters_.size() > 1) result.sum_cost = empty_costs;
    for (PassCounters& counters : counters_) {
        Phase phase;
        phase.name = result.phases.empty() ? kTracePass : kSupersamplePass;
        phase.recorded_cost = empty_costs;
        result.phases.push_back(std::move(phase));
        tracer_->clear(counters);
    }
}

void RingRenderer::trace(PixelRange range, RingResult& result, const ProgressCallback& progress) {
    const SpanLog::Span span = session_.span(kTracePass);
    const double passes = static_cast<double>(counters_.size());
    const auto report = [&](double done) {
        ranks_.poll_failures();
        if (progress) progress((range.begin + done * (range.end - range.begin)) / share_pixels_ / passes);
    };
    trace_in_bands(0, range, result, [&](PixelRange band) {
        range = band;
        tracer_->trace(kTracePass, broadcast_, band, RAYA_POINTS_OWN, no_marks_, pixels_, counters_[0],
                       progress || polls_failures() ? report : ProgressCallback{},
                       [&] { place_gathered_and_allocate(result); });
    });
}

void RingRenderer::supersample(RingResult& result, const ProgressCallback& progress) {
    const SpanLog::Span span = session_.span(kSupersamplePass);
    if (!resumed_ || position_.pass == 0) contrast_->apply(pixels_, *exchange_);
    PixelRange range{0, 0, share_pixels_};
    const auto report = [&](double done) {
        ranks_.poll_failures();
        if (progress) progress((1 + (range.begin + done * (range.end - range.begin)) / share_pixels_) / 2);
    };
    trace_in_bands(1, range, result, [&](PixelRange band) {
        range = band;
        tracer_->trace(kSupersamplePass, broadcast_, band, settings_.antialias.points, contrast_->marks(), pixels_,
                       counters_[1], progress || polls_failures() ? report : ProgressCallback{});
    });
}

// OpenCL work-groups cannot distribute pixels among each other at run time, so the dynamic distribution is simulated
// from the pixels' costs.
void RingRenderer::simulate_schedule(RingResult& result) {
    const SpanLog::Span span = session_.span("simulate schedule");
    const Schedule schedule = dynamic_schedule(result.cost(), settings_.mapping, *settings_.dynamic);
    result.requests = schedule.requests;
    result.load = result.phases.front().load = schedule.load;
}

void RingRenderer::describe(RingResult& result) {
    result.scale = job_.scale;
    result.communication = communication_;
    result.pe_memory = memory_;
    if (settings_.accel.kind != AccelKind::kNone) result.accel = job_.accel;
    result.words_local = tracer_->options().words_local;
    result.first_pe = pes_.first();
    result.parts_of_rank = pes_.count();
    result.lanes = settings_.kernels.lanes;
    result.group_size = settings_.kernels.group_size;
    result.build_options = tracer_->build_options();
    result.tuned = settings_.kernels.origin;
    result.accel_s = job_.accel_s;
    result.build_s = build_s_;
    result.commands = session_.profile().summary();
}

}  // namespace raya
