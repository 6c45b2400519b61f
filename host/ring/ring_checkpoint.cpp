// Checkpoints of a ring render: tracing the image in bands, saving the state between bands, and resuming the render.
#include <fmt/core.h>

#include <algorithm>

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

}  // namespace raya
