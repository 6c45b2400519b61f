#include "host/ring/ring_renderer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/parallel.hpp"
#include "host/error.hpp"
#include "host/ring/mapping.hpp"
#include "host/version.hpp"
#include "kernels/shared/share_pixels.h"

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
    options.accel = RAYA_ACCEL_NONE;  // these kernels do not read the scene
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

namespace {

constexpr std::uint32_t kFirstBandDivisor = 64;  // the first band is 1 / kFirstBandDivisor of a share
constexpr std::uint32_t kMinPixelsPerLane = 16;  // minimum in the first band, so that no lane is idle

// Returns the length of the next band in pixels of each PE. `last_band`: length of the last band, which took `seconds`.
// The new length is scaled so that the band takes `target_s` seconds, but is between half and four times the last
// length.
std::uint32_t next_band(std::uint32_t last_band, double seconds, double target_s) {
    const double factor = std::clamp(target_s / std::max(seconds, 1e-6), 0.5, 4.0);
    return static_cast<std::uint32_t>(std::clamp(last_band * factor, 1.0, 1e9));
}

}  // namespace

void RingRenderer::trace_in_bands(std::uint32_t pass, PixelRange range, RingResult& result,
                                  const std::function<void(PixelRange)>& trace) {
    if (!checkpoints_->active()) return trace(range);
    if (resumed_ && position_.pass > pass) return;
    if (resumed_ && position_.pass == pass) range.begin = std::max(range.begin, position_.next);
    while (range.begin < range.end) {
        const Clock::time_point start = Clock::now();
        PixelRange band = range;
        band.end = range.begin + std::min(band_, range.end - range.begin);
        trace(band);
        range.begin = band.end;
        // The next band must have the same length in all ranks, so the slowest rank determines it.
        const std::vector<double> seconds = ranks_.all_gather(seconds_since(start));
        band_ = next_band(band_, *std::max_element(seconds.begin(), seconds.end()), checkpoints_->band_s());
        position_ = {pass, range.window_start, range.begin};
        const double fraction = (pass + 1.0 * range.begin / share_pixels_) / static_cast<double>(counters_.size());
        checkpoints_->save_if_due(fraction, [&](RenderState& state) { visit_state(state, result); });
    }
}

StateSettings RingRenderer::state_settings() const {
    const raya_mapping& m = settings_.mapping;
    const Antialias& a = settings_.antialias;
    return {{"raya", raya_version()},
            {"a machine of type", "ring"},
            {"--size", fmt::format("{}x{}", m.width, m.height)},
            {"--mapping", mapping_text(m)},
            {"--fold", m.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic"},
            {"--pes", std::to_string(m.pes)},
            {"--format", format_name(settings_.format)},
            {"--antialias", antialias_name(a.method)},
            {"--exchange", exchange_name(a.exchange)},
            {"--points", points_name(a.points)},
            {"--threshold", fmt::format("{}", a.threshold)},
            {"--bounces", std::to_string(settings_.bounces)},
            {"--sampling", settings_.sampling == Sampling::kCorners ? "corners" : "centres"},
            {"--accel", accel_text(settings_.accel)},
            {"--cost or --mapping dynamic", records_costs() ? "yes" : "no"},
            {"a device window of", fmt::format("{} pixels", window_)},
            {"another scene, camera or light", words_hash(job_.job.words())}};
}

void RingRenderer::visit_state(RenderState& state, RingResult& result) {
    place_gathered_and_allocate(result);
    for (std::uint32_t* number : {&position_.pass, &position_.window, &position_.next}) state.value(*number);
    if (position_.pass >= counters_.size()) throw UserError("damaged");
    state.value(communication_);
    state.rank_0(result.image.rgb);
    state.buffer(pixels_);
    if (contrast_) state.buffer(contrast_->marks());
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        state.buffer(counters_[i].cycles);
        // The events of a PE's work-items are summed, so that the group size may change.
        std::vector<std::uint64_t> counts(counters_[i].events.size()), sums(std::size_t{RAYA_EVENTS} * pes_.count());
        if (!state.restores()) session_.read("save", counters_[i].events, counts);
        const std::size_t pe_counts = counts.size() / pes_.count();
        for (std::size_t n = 0; n < counts.size(); ++n)
            sums[n / pe_counts * RAYA_EVENTS + n % RAYA_EVENTS] += counts[n];
        state.elements(sums, RAYA_EVENTS);
        for (std::size_t n = 0; n < sums.size(); ++n) counts[n / RAYA_EVENTS * pe_counts + n % RAYA_EVENTS] = sums[n];
        if (state.restores()) session_.write("resume", counters_[i].events, counts);
        if (auto& cost = result.phases[i].recorded_cost) state.rank_0(cost->cycles);
    }
    if (result.sum_cost) state.rank_0(result.sum_cost->cycles);
}

void RingRenderer::resume(RingResult& result) {
    const std::uint32_t lanes_per_pe = settings_.kernels.lanes * settings_.kernels.group_size;
    band_ = std::max(share_pixels_ / kFirstBandDivisor, kMinPixelsPerLane * lanes_per_pe);
    ranks_.broadcast(band_);
    resumed_ = checkpoints_->resume([&](RenderState& state) { visit_state(state, result); });
}

namespace {

constexpr std::uint32_t kInterleavedPes = 16;

/// Calls visit(PE, pixel, image pixel) for the pixels in `range` of the share of each of `count` PEs from `first_pe`
/// on. The arguments are the index of the PE, from 0 on, the index of the pixel in the PE's device buffer, and the
/// index of the pixel in the image. Neighbouring PEs often own neighbouring columns, so the runs of kInterleavedPes PEs
/// are interleaved for memory locality.
template <class Visit>
void for_each_pixel(const raya_mapping& m, std::uint32_t first_pe, std::uint32_t count, PixelRange range,
                    Visit&& visit) {
    for (std::uint32_t first = 0; first < count; first += kInterleavedPes) {
        const std::uint32_t pes = std::min(kInterleavedPes, count - first);
        std::array<raya_share, kInterleavedPes> shares{};
        for (std::uint32_t i = 0; i < pes; ++i) shares[i] = raya_share_of(m, first_pe + first + i);
        std::uint32_t pixels = 0;
        for (std::uint32_t k = range.begin; k < range.end; k += pixels) {
            std::array<raya_pixel_run, kInterleavedPes> runs{};
            pixels = range.end - k;
            for (std::uint32_t i = 0; i < pes; ++i) {
                const std::uint32_t size = raya_share_size(shares[i]);
                if (k >= size) continue;
                runs[i] = raya_pixel_run_of(m, shares[i], k);
                pixels = std::min({pixels, size - k, runs[i].left + 1});
            }
            for (std::uint32_t i = 0; i < pes; ++i) {
                if (k >= raya_share_size(shares[i])) continue;
                const std::size_t row = std::size_t{runs[i].pixel.row} * m.width;
                std::uint32_t column = runs[i].pixel.column;
                for (std::uint32_t j = 0; j < pixels; ++j) {
                    visit(first + i, k - range.window_start + j, row + column);
                    column += runs[i].step;
                    if (column >= m.width) column -= m.width;
                }
            }
        }
    }
}

Image black_image(const raya_mapping& m) {
    Image image{static_cast<int>(m.width), static_cast<int>(m.height), {}};
    resize_in_huge_pages(image.rgb, 3 * std::size_t{m.width} * m.height);
    return image;
}

// Throws DeviceError unless one primary ray was counted for each pixel of this rank. Some devices silently end long
// loops (Mesa's llvmpipe after 65,535 iterations of a work-item), so that pixels would be missing.
void check_all_traced(const EventCounts& first_pass, const raya_mapping& m, const Distribution& pes,
                      const DeviceInfo& device) {
    std::uint64_t pixels = 0;
    for (const std::uint32_t pe : pes.own()) pixels += raya_share_size(raya_share_of(m, pe));
    const std::uint64_t traced = first_pass[RAYA_PRIMARY];
    if (traced == pixels) return;
    throw DeviceError(fmt::format(
        "{} {} ended the trace kernel after {} of {} pixels; remedy: run raya verify; use more PEs (--pes), "
        "which give each work-item fewer pixels and do not change the image, or another device",
        device.platform, device.name, traced, pixels));
}

// Adds the event counts of all ranks to the counts of the phase and of the whole render.
void add_events(const std::vector<EventCounts>& rank_events, EventCounts& phase_events, EventCounts& all_events) {
    for (const EventCounts& events : rank_events)
        for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
            phase_events[event] += events[event];
            all_events[event] += events[event];
        }
}

}  // namespace

// Copies the pixels of the last gather into the image, and allocates the host memory for the next gather in advance, as
// the first access to new memory is slow. trace() calls this function while the device traces.
void RingRenderer::place_gathered_and_allocate(RingResult& result) {
    const SpanLog::Span span = session_.span("prepare memory");
    if (result.image.rgb.empty() && ranks_.is_first()) result.image = black_image(settings_.mapping);
    place_gathered_pixels(result);
    resize_in_huge_pages(gathered_, pixels_.size());
}

void RingRenderer::gather(PixelRange range) {
    const SpanLog::Span span = session_.span("gather");
    const raya_mapping& m = settings_.mapping;
    std::uint64_t gathered_pixels = 0;
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const std::uint32_t share = raya_share_size(raya_share_of(m, pe));
        gathered_pixels += share > range.begin ? std::min(share, range.end) - range.begin : 0;
    }
    bus_.gather(pixels_, gathered_, 3 * gathered_pixels);
    gathered_ = pes_.gather(std::move(gathered_), std::size_t{3} * window_);
    gathered_range_ = range;
}

void RingRenderer::place_gathered_pixels(RingResult& result) {
    const PixelRange range = std::exchange(gathered_range_, {});
    if (range.end == 0 || !ranks_.is_first()) return;
    const std::size_t window = window_;
    float* const image = result.image.rgb.data();
    constexpr std::size_t kFewPixels = 1 << 16;
    const std::uint32_t pes = pes_.all(), parts = (pes + kInterleavedPes - 1) / kInterleavedPes;
    parallel_for(parts, gathered_.size() > 3 * kFewPixels ? core_count() : 1, [&](std::size_t part) {
        const auto first = static_cast<std::uint32_t>(part) * kInterleavedPes;
        const float* const colours = gathered_.data() + 3 * first * window;
        for_each_pixel(settings_.mapping, first, std::min(kInterleavedPes, pes - first), range,
                       [=](std::size_t pe, std::size_t pixel, std::size_t image_pixel) {
                           const float* const red = colours + 3 * pe * window + pixel;
                           image[3 * image_pixel] = *red;
                           image[3 * image_pixel + 1] = red[window];
                           image[3 * image_pixel + 2] = red[2 * window];
                       });
    });
}

// Reads the cost of each pixel for reports. The modelled machine does not make this transfer, so it is not counted.
void RingRenderer::collect_costs(PixelRange range, RingResult& result) {
    if (!records_costs()) return;
    const SpanLog::Span span = session_.span("collect costs");
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        std::vector<std::uint64_t> cycles(counters_[i].cycles.size());
        session_.read("read cost", counters_[i].cycles, cycles);
        cycles = pes_.gather(std::move(cycles), window_);
        if (!ranks_.is_first()) continue;
        for_each_pixel(settings_.mapping, 0, pes_.all(), range,
                       [&](std::size_t pe, std::size_t pixel, std::size_t image_pixel) {
                           const std::uint64_t cost = cycles[pe * window_ + pixel];
                           result.phases[i].recorded_cost->cycles[image_pixel] = cost;
                           if (result.sum_cost) result.sum_cost->cycles[image_pixel] += cost;
                       });
    }
}

void RingRenderer::collect_marks(RingResult& result) {
    const SpanLog::Span span = session_.span("collect marks");
    std::vector<std::uint8_t> marks(contrast_->marks().size());
    session_.read("read marks", contrast_->marks(), marks);
    for (const std::uint8_t mark : marks) result.rank_recomputed += mark;
    marks = pes_.gather(std::move(marks), window_);
    if (!ranks_.is_first()) return;
    result.mask = black_image(settings_.mapping);
    for_each_pixel(settings_.mapping, 0, pes_.all(), {0, 0, share_pixels_},
                   [&](std::size_t pe, std::size_t pixel, std::size_t image_pixel) {
                       const std::uint8_t mark = marks[pe * window_ + pixel];
                       result.recomputed += mark;
                       std::fill_n(result.mask.rgb.begin() + static_cast<std::ptrdiff_t>(3 * image_pixel), 3,
                                   static_cast<float>(mark));
                   });
}

void RingRenderer::collect_events(RingResult& result) {
    const SpanLog::Span span = session_.span("collect events");
    const auto cycles = cycles_of_events();
    std::vector<std::uint64_t> sum_loads(settings_.mapping.pes);
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        std::vector<std::uint64_t> counts(counters_[i].events.size()), loads(pes_.count());
        session_.read("read counters", counters_[i].events, counts);
        EventCounts events{};
        for (std::size_t n = 0; n < counts.size(); ++n) {
            const std::size_t event = n % RAYA_EVENTS, pe = n / RAYA_EVENTS / settings_.kernels.group_size;
            events[event] += counts[n];
            loads[pe] += cycles[event] * counts[n];
        }
        result.phases[i].rank_events = events;
        if (i == 0) check_all_traced(events, settings_.mapping, pes_, session_.device());
        add_events(ranks_.all_gather(events), result.phases[i].events, result.events);
        loads = pes_.gather(std::move(loads), 1);
        std::transform(loads.begin(), loads.end(), sum_loads.begin(), sum_loads.begin(), std::plus<>());
        if (ranks_.is_first()) result.phases[i].load = load_of(std::move(loads));
    }
    if (ranks_.is_first()) result.load = load_of(std::move(sum_loads));
}

}  // namespace raya
