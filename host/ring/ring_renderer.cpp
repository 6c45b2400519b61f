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

constexpr std::uint32_t kFirstBandDivisor = 64;  // the first band is 1 / kFirstBandDivisor of a share
constexpr std::uint32_t kMinPixelsPerLane = 16;  // minimum in the first band, so that no lane is idle

// Returns the length of the next band in pixels of each PE. `last_band`: length of the last band, which took `seconds`.
// The new length is scaled so that the band takes `target_s` seconds, but is between half and four times the last
// length.
std::uint32_t next_band(std::uint32_t last_band, double seconds, double target_s) {
    const double factor = std::clamp(target_s / std::max(seconds, 1e-6), 0.5, 4.0);
    return static_cast<std::uint32_t>(std::clamp(last_band * factor, 1.0, 1e9));
}

Image black_image(const raya_mapping& m) {
    Image image{static_cast<int>(m.width), static_cast<int>(m.height), {}};
    resize_in_huge_pages(image.rgb, 3 * std::size_t{m.width} * m.height);
    return image;
}

/// Calls visit(pixel, image pixel) for the pixels in `range` of the share of a PE. The arguments are the index of the
/// pixel in the PE's device buffer, and the index of the pixel in the image.
template <class Visit>
void for_each_pixel(const raya_mapping& m, std::size_t pe, PixelRange range, Visit&& visit) {
    const raya_share share = raya_share_of(m, static_cast<std::uint32_t>(pe));
    const std::uint32_t end = std::min(range.end, raya_share_size(share));
    if (range.begin >= end) return;
    raya_pixel_run run = raya_pixel_run_of(m, share, range.begin);
    for (std::uint32_t k = range.begin; k < end; ++k) {
        if (k > range.begin) run = raya_pixel_run_at(run, m, share, k);
        visit(std::size_t{k - range.window_start}, std::size_t{run.pixel.row} * m.width + run.pixel.column);
    }
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

}  // namespace

RingRenderer::RingRenderer(Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks,
                           const std::function<void()>& packed)
    : session_(session),
      ranks_(ranks),
      settings_(checked_settings(settings, session.device())),
      pes_(Distribution(settings_.mapping.pes, ranks)),
      job_(make_ring_job(session, scene, settings_, ranks, packed)),
      stored_(store_scene(job_.job, settings_, scene.name)),
      share_pixels_(largest_share(settings_.mapping)),
      memory_(stored_.memory),
      window_(device_window(memory_, settings_)),
      bus_(session, communication_, pes_),
      broadcast_(session.buffer_of("broadcast words", std::span(stored_.words(job_.job)))),
      pixels_(session.buffer<float>("pixel blocks", 3ull * pes_.count() * window_)),
      no_marks_(session.buffer<std::uint8_t>("no marks", 1)) {
    ranks_.one_rank_per_host_first([this] { build(); });
}

void RingRenderer::build() {
    const SpanLog::Span building = session_.span("set up device");
    const std::jthread notice = session_.compile_notice();
    const Clock::time_point start = Clock::now();
    const KernelOptions options =
        kernel_options(settings_, job_.job, memory_.job_words + memory_.part_words, job_.accel, session_.device());
    Kernels kernels(session_, options, settings_.kernels.sources);
    if (stored_.parts) {
        auto turns = std::make_unique<Turns>(kernels, communication_, pes_, window_, *stored_.parts, memory_.trees);
        turns_ = turns.get();
        tracer_ = std::move(turns);
    } else {
        tracer_ = std::make_unique<Tracer>(kernels, pes_, window_,
                                           launch_work(settings_, options, job_.objects, pes_.count()));
    }
    counters_.push_back(tracer_->make_counters(kTracePass));
    bus_.broadcast(broadcast_, stored_.words(job_.job));
    tracer_->clear(counters_.front());
    tracer_->warm_up({"warm-up", broadcast_, {}, RAYA_POINTS_OWN, no_marks_, pixels_, counters_.front()});
    if (settings_.antialias.method != AntialiasMethod::kNone) build_exchange(options);
    session_.finish();
    build_s_ = seconds_since(start);
}

void RingRenderer::build_exchange(KernelOptions options) {
    options.lanes = 1;
    options.accel = RAYA_ACCEL_NONE;  // these kernels do not read the scene
    Kernels kernels(session_, options, settings_.kernels.sources);
    NeighbourExchange exchange(session_, communication_, settings_.mapping, memory_.block_pixels, memory_.band_pixels,
                               settings_.antialias.exchange, pes_);
    if (settings_.antialias.method == AntialiasMethod::kFilter) {
        filter_ = std::make_unique<RingFilter>(kernels, std::move(exchange), broadcast_);
        return;
    }
    contrast_ = std::make_unique<RingContrast>(kernels, std::move(exchange), broadcast_,
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
    bus_.broadcast(broadcast_, stored_.words(job_.job));
    if (turns_) turns_->broadcast_parts();
    if (checkpointing) resume(result);
    for (std::uint32_t block_begin = 0; block_begin < share_pixels_; block_begin += memory_.block_pixels)
        render_block(block_begin, result, progress);
    if (contrast_) collect_marks(result);
    collect_events(result);
    if (settings_.dynamic && ranks_.is_first()) simulate_schedule(result);
    result.render_s = checkpoints_->seconds();
    result.earlier_s = checkpoints_->earlier_s();
    result.traffic = ranks_.traffic() - traffic_before;
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
        trace(0, range, result, progress);
        if (filter_) filter_->apply(pixels_);
        if (contrast_) {
            if (!resumed_ || position_.pass == 0) contrast_->apply(pixels_);
            trace(1, range, result, progress);
        }
        gather(range, result);
        collect_costs(range, result);
        resumed_ = false;
    }
}

void RingRenderer::prepare(RingResult& result) {
    const SpanLog::Span span = session_.span("prepare");
    const std::size_t pixels = std::size_t{settings_.mapping.width} * settings_.mapping.height;
    if (ranks_.is_first()) result.image = black_image(settings_.mapping);
    std::optional<CostImage> empty_costs;
    if (records_costs() && ranks_.is_first())
        empty_costs = CostImage{settings_.mapping.width, settings_.mapping.height, std::vector<std::uint64_t>(pixels)};
    if (counters_.size() > 1) result.sum_cost = empty_costs;
    for (PassCounters& counters : counters_) {
        result.phases.push_back(
            {.name = result.phases.empty() ? kTracePass : kSupersamplePass, .recorded_cost = empty_costs});
        tracer_->clear(counters);
    }
}

// Traces the range in pass 0 (trace) or 1 (supersample); with checkpoints, band by band.
void RingRenderer::trace(std::uint32_t pass, PixelRange range, RingResult& result, const ProgressCallback& progress) {
    const char* const label = pass == 0 ? kTracePass : kSupersamplePass;
    const SpanLog::Span span = session_.span(label);
    if (resumed_ && position_.pass > pass) return;
    if (resumed_ && position_.pass == pass) range.begin = std::max(range.begin, position_.next);
    PixelRange band = range;
    const auto save = [&](std::uint32_t next, double done) {
        position_ = {pass, range.window_start, next};
        const double fraction = (pass + done / share_pixels_) / static_cast<double>(counters_.size());
        checkpoints_->save_if_due(fraction, [&](RenderState& state) { visit_state(state, result); });
    };
    if (turns_)  // saves after turns instead of bands, which would empty the PEs
        turns_->after_turn([&](double done) { save(range.begin, range.begin + done * (range.end - range.begin)); });
    const auto report = [&](double done) {
        ranks_.poll_failures();
        const double pixels = band.begin + done * (band.end - band.begin);
        if (progress) progress((pass + pixels / share_pixels_) / static_cast<double>(counters_.size()));
    };
    for (; band.begin < range.end; band.begin = band.end) {
        const Clock::time_point start = Clock::now();
        const bool has_bands = checkpoints_->active() && !turns_;
        band.end = has_bands ? band.begin + std::min(band_, range.end - band.begin) : range.end;
        const raya_u32 points = pass == 0 ? raya_u32{RAYA_POINTS_OWN} : settings_.antialias.points;
        tracer_->trace(
            {label, broadcast_, band, points, pass == 0 ? no_marks_ : contrast_->marks(), pixels_, counters_[pass]},
            progress || (ranks_.has_several() && ranks_.is_first()) ? report : ProgressCallback{});
        if (!has_bands) continue;
        // The next band must have the same length in all ranks, so the slowest rank determines it.
        const std::vector<double> seconds = ranks_.all_gather(seconds_since(start));
        band_ = next_band(band_, *std::max_element(seconds.begin(), seconds.end()), checkpoints_->band_s());
        save(band.end, band.end);
    }
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
    if (stored_.parts) result.parts = stored_.parts->parts;
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
            {"--split", std::to_string(stored_.parts ? stored_.parts->parts : 1)},
            {"memory of a PE for", fmt::format("{} rays", memory_.trees)},
            {"another scene, camera or light", words_hash(job_.job.words())}};
}

void RingRenderer::visit_state(RenderState& state, RingResult& result) {
    for (std::uint32_t* number : {&position_.pass, &position_.window, &position_.next}) state.value(*number);
    if (position_.pass >= counters_.size()) throw UserError("damaged");
    state.value(communication_);
    state.rank_0(result.image.rgb);
    state.buffer(pixels_);
    if (contrast_) state.buffer(contrast_->marks());
    std::uint64_t turns = 0;
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
        if (turns_) state.vector(counters_[i].turn_cycles, true);
        turns += counters_[i].turn_cycles.size();
    }
    if (turns_) turns_->visit_state(state, turns);
    if (result.sum_cost) state.rank_0(result.sum_cost->cycles);
}

void RingRenderer::resume(RingResult& result) {
    const std::uint32_t lanes_per_pe = settings_.kernels.lanes * settings_.kernels.group_size;
    band_ = std::max(share_pixels_ / kFirstBandDivisor, kMinPixelsPerLane * lanes_per_pe);
    ranks_.broadcast(band_);
    resumed_ = checkpoints_->resume([&](RenderState& state) { visit_state(state, result); });
}

// Reads the pixels in `range` of every PE's share, and places them in the image.
void RingRenderer::gather(PixelRange range, RingResult& result) {
    const SpanLog::Span span = session_.span("gather");
    const raya_mapping& m = settings_.mapping;
    std::uint64_t gathered_pixels = 0;
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const std::uint32_t share = raya_share_size(raya_share_of(m, pe));
        gathered_pixels += share > range.begin ? std::min(share, range.end) - range.begin : 0;
    }
    const std::size_t window = window_;
    std::vector<float> gathered;
    resize_in_huge_pages(gathered, pixels_.size());
    bus_.gather(pixels_, gathered, 3 * gathered_pixels);
    gathered = pes_.gather(std::move(gathered), 3 * window);
    if (!ranks_.is_first()) return;
    constexpr std::size_t kFewPixels = 1 << 16;
    parallel_for(m.pes, gathered.size() > 3 * kFewPixels ? core_count() : 1, [&](std::size_t pe) {
        const float* const red = &gathered[3 * pe * window];
        float* const image = result.image.rgb.data();
        for_each_pixel(m, pe, range, [=](std::size_t pixel, std::size_t image_pixel) {
            for (std::size_t colour = 0; colour < 3; ++colour)
                image[3 * image_pixel + colour] = red[colour * window + pixel];
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
        for (std::size_t pe = 0; pe < pes_.all(); ++pe)
            for_each_pixel(settings_.mapping, pe, range, [&](std::size_t pixel, std::size_t image_pixel) {
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
    for (std::size_t pe = 0; pe < pes_.all(); ++pe)
        for_each_pixel(settings_.mapping, pe, {0, 0, share_pixels_}, [&](std::size_t pixel, std::size_t image_pixel) {
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
        Phase& phase = result.phases[i];
        phase.rank_events = events;
        phase.turn_cycles = counters_[i].turn_cycles;
        if (i == 0) check_all_traced(events, settings_.mapping, pes_, session_.device());
        for (const EventCounts& of_rank : ranks_.all_gather(events))
            for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
                phase.events[event] += of_rank[event];
                result.events[event] += of_rank[event];
            }
        loads = pes_.gather(std::move(loads), 1);
        std::transform(loads.begin(), loads.end(), sum_loads.begin(), sum_loads.begin(), std::plus<>());
        if (ranks_.is_first()) phase.load = load_of(std::move(loads));
    }
    if (ranks_.is_first()) result.load = load_of(std::move(sum_loads));
}

}  // namespace raya
