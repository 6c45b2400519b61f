// Checkpoints of a ring render: tracing the image in bands, saving the state between bands, and resuming the render.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/base/clock.hpp"
#include "host/base/encoding.hpp"
#include "host/error.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kFirstBandDivisor = 64;  // the first band is 1 / kFirstBandDivisor of a share
constexpr std::uint32_t kMinPixelsPerLane = 16;  // minimum in the first band, so that no lane is idle

std::string words_hash(const std::vector<std::uint32_t>& words) {
    return bytes_hash({reinterpret_cast<const char*>(words.data()), words.size() * sizeof words[0]});
}

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
    if (checkpointing_ == nullptr) return trace(range);
    if (resumed_ && resumed_->pass > pass) return;
    if (resumed_ && resumed_->pass == pass) range.begin = std::max(range.begin, resumed_->next);
    while (range.begin < range.end) {
        const Clock::time_point start = Clock::now();
        PixelRange band = range;
        band.end = range.begin + std::min(band_, range.end - range.begin);
        trace(band);
        band_ = next_band(band_, seconds_since(start), checkpointing_->band_s);
        range.begin = band.end;
        if (checkpointing_->due()) save_checkpoint(pass, range, result);
    }
}

StateSettings RingRenderer::state_settings() const {
    const raya_mapping& m = settings_.mapping;
    const Antialias& a = settings_.antialias;
    return {{"raya", raya_version()},
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
            {"--group", std::to_string(settings_.kernels.group_size)},
            {"a device window of", fmt::format("{} pixels", window_)},
            {"another scene, camera or light", words_hash(job_.job.words())}};
}

// Returns the part of the state that is on the host. The vectors for the part on the device have the right sizes but no
// contents.
RingState RingRenderer::host_state(const RingResult& result) const {
    RingState s;
    s.seconds = earlier_s_ + seconds_since(started_);
    s.communication = communication_;
    s.image = result.image.rgb;
    s.pixels.resize(pixels_.size());
    if (contrast_) s.marks.resize(contrast_->marks().size());
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        RingState::Pass& pass = s.passes.emplace_back();
        pass.cycles.resize(counters_[i].cycles.size());
        pass.events.resize(counters_[i].events.size());
        if (result.phases[i].recorded_cost) pass.costs = result.phases[i].recorded_cost->cycles;
    }
    if (result.all.recorded_cost) s.all_costs = result.all.recorded_cost->cycles;
    return s;
}

RingState RingRenderer::checkpoint_state(const RingResult& result) {
    RingState s = host_state(result);
    session_.read("save pixels", pixels_, s.pixels);
    if (contrast_) session_.read("save marks", contrast_->marks(), s.marks);
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        session_.read("save counters", counters_[i].cycles, s.passes[i].cycles);
        session_.read("save counters", counters_[i].events, s.passes[i].events);
    }
    return s;
}

void RingRenderer::save_checkpoint(std::uint32_t pass, PixelRange range, RingResult& result) {
    const SpanLog::Span span = session_.span("save checkpoint");
    place_gathered_and_allocate(result);
    RingState s = checkpoint_state(result);
    s.pass = pass;
    s.window = range.window_start;
    s.next = range.begin;
    s.fraction = (pass + 1.0 * range.begin / share_pixels_) / static_cast<double>(counters_.size());
    checkpointing_->save(s, state_settings());
}

void RingRenderer::resume(RingResult& result) {
    resumed_.reset();
    earlier_s_ = 0;
    if (checkpointing_ == nullptr) return;
    if (ranks_.has_several())
        throw UserError("a render on several ranks cannot save checkpoints; start raya without mpirun");
    const std::uint32_t lanes_per_pe = settings_.kernels.lanes * settings_.kernels.group_size;
    band_ = std::max(share_pixels_ / kFirstBandDivisor, kMinPixelsPerLane * lanes_per_pe);
    if (!checkpointing_->resume) return;
    place_gathered_and_allocate(result);
    resumed_ = checkpointing_->resume(state_settings(), host_state(result));
    if (!resumed_) return;
    const SpanLog::Span span = session_.span("resume");
    RingState& s = *resumed_;
    earlier_s_ = s.seconds;
    communication_ = s.communication;
    result.image.rgb = std::move(s.image);
    session_.write("resume", pixels_, s.pixels);
    if (contrast_) contrast_->set_marks(s.marks);
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        session_.write("resume", counters_[i].cycles, s.passes[i].cycles);
        session_.write("resume", counters_[i].events, s.passes[i].events);
        if (result.phases[i].recorded_cost) result.phases[i].recorded_cost->cycles = std::move(s.passes[i].costs);
    }
    if (result.all.recorded_cost) result.all.recorded_cost->cycles = std::move(s.all_costs);
}

}  // namespace raya
