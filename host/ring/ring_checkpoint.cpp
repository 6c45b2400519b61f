// Checkpoints of a ring render: tracing the image in bands, saving the state between bands, and resuming the render.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

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
    if (checkpointing_ == nullptr) return trace(range);
    if (resumed_ && resumed_->pass > pass) return;
    if (resumed_ && resumed_->pass == pass) range.begin = std::max(range.begin, resumed_->next);
    while (range.begin < range.end) {
        const Clock::time_point start = Clock::now();
        PixelRange band = range;
        band.end = range.begin + std::min(band_, range.end - range.begin);
        trace(band);
        range.begin = band.end;
        // The next band must have the same length in all ranks, so the slowest rank determines it.
        const std::vector<double> seconds = ranks_.all_gather(seconds_since(start));
        band_ = next_band(band_, *std::max_element(seconds.begin(), seconds.end()), checkpointing_->band_s);
        char is_due = ranks_.is_first() && checkpointing_->due();
        ranks_.broadcast(is_due);
        if (is_due) save_checkpoint(pass, range, result);
    }
}

// Replaces the elements of this rank's PEs by those of all PEs in rank 0, and by an empty vector in other ranks.
template <class T>
void RingRenderer::gather_pes(std::vector<T>& elements) {
    if (!ranks_.has_several()) return;
    std::vector<std::size_t> sizes;
    for (std::uint32_t rank = 0; rank < ranks_.count(); ++rank)
        sizes.push_back(elements.size() / pes_.count * segment_of(settings_.mapping.pes, ranks_.count(), rank).count);
    elements = ranks_.gather(std::span<const T>(elements), sizes);
}

// Inverse of gather_pes(). `per_pe`: number of elements of a PE.
template <class T>
void RingRenderer::scatter_pes(std::vector<T>& elements, std::size_t per_pe) {
    for (std::uint32_t rank = 1; ranks_.is_first() && rank < ranks_.count(); ++rank) {
        const PeSegment pes = segment_of(settings_.mapping.pes, ranks_.count(), rank);
        ranks_.send(rank, std::span<const T>(elements).subspan(per_pe * pes.first, per_pe * pes.count));
    }
    elements.resize(per_pe * pes_.count);  // in rank 0, keeps its elements, which are the first
    if (!ranks_.is_first()) ranks_.receive(0, std::span(elements));
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

// Returns the part of the state that is on the host of rank 0. The vectors for the part on the devices have the sizes
// for all PEs but no contents.
RingState RingRenderer::host_state(const RingResult& result) const {
    const std::size_t pes = settings_.mapping.pes;
    RingState s;
    s.part.seconds = earlier_s_ + seconds_since(started_);
    s.communication = communication_;
    s.image = result.image.rgb;
    s.pixels.resize(3 * window_ * pes);
    if (contrast_) s.marks.resize(window_ * pes);
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        RingState::Pass& pass = s.passes.emplace_back();
        pass.cycles.resize(window_ * pes);
        pass.events.resize(RAYA_EVENTS * pes);
        if (result.phases[i].recorded_cost) pass.costs = result.phases[i].recorded_cost->cycles;
    }
    if (result.all.recorded_cost) s.all_costs = result.all.recorded_cost->cycles;
    return s;
}

// Reads the elements of this rank's PEs from a buffer, and gathers those of all PEs in rank 0.
template <class T>
std::vector<T> RingRenderer::read_pes(const Buffer<T>& buffer) {
    std::vector<T> elements(buffer.size());
    session_.read("save", buffer, elements);
    gather_pes(elements);
    return elements;
}

RingState RingRenderer::checkpoint_state(const RingResult& result) {
    RingState s = host_state(result);
    s.pixels = read_pes(pixels_);
    if (contrast_) s.marks = read_pes(contrast_->marks());
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        s.passes[i].cycles = read_pes(counters_[i].cycles);
        std::vector<std::uint64_t> counts(counters_[i].events.size()), sums(std::size_t{RAYA_EVENTS} * pes_.count);
        session_.read("save", counters_[i].events, counts);
        for (std::size_t n = 0; n < counts.size(); ++n)
            sums[n / RAYA_EVENTS / settings_.kernels.group_size * RAYA_EVENTS + n % RAYA_EVENTS] += counts[n];
        gather_pes(sums);
        s.passes[i].events = std::move(sums);
    }
    return s;
}

void RingRenderer::save_checkpoint(std::uint32_t pass, PixelRange range, RingResult& result) {
    const SpanLog::Span span = session_.span("save checkpoint");
    place_gathered_and_allocate(result);
    RingState s = checkpoint_state(result);
    if (!ranks_.is_first()) return;
    s.pass = pass;
    s.window = range.window_start;
    s.next = range.begin;
    s.part.fraction = (pass + 1.0 * range.begin / share_pixels_) / static_cast<double>(counters_.size());
    checkpointing_->save(state_bytes(s, state_settings()));
}

void RingRenderer::resume(RingResult& result) {
    resumed_.reset();
    earlier_s_ = 0;
    if (checkpointing_ == nullptr) return;
    const std::uint32_t lanes_per_pe = settings_.kernels.lanes * settings_.kernels.group_size;
    band_ = std::max(share_pixels_ / kFirstBandDivisor, kMinPixelsPerLane * lanes_per_pe);
    ranks_.broadcast(band_);
    if (!checkpointing_->resume) return;
    place_gathered_and_allocate(result);
    if (ranks_.is_first())
        checkpointing_->resume([&](std::string_view bytes) {
            resumed_ = read_state(bytes, state_settings(), host_state(result));
            return resumed_->part;
        });
    char resumes = resumed_.has_value();
    ranks_.broadcast(resumes);
    if (!resumes) return;
    const SpanLog::Span span = session_.span("resume");
    if (!ranks_.is_first()) resumed_.emplace().passes.resize(counters_.size());
    restore(*resumed_, result);
}

// Continues from a state of all PEs. Only rank 0 has the state's contents.
void RingRenderer::restore(RingState& s, RingResult& result) {
    for (std::uint32_t* number : {&s.pass, &s.window, &s.next}) ranks_.broadcast(*number);
    ranks_.broadcast(s.part.seconds);
    ranks_.broadcast(s.communication);
    earlier_s_ = s.part.seconds;
    communication_ = s.communication;
    result.image.rgb = std::move(s.image);
    scatter_pes(s.pixels, std::size_t{3} * window_);
    session_.write("resume", pixels_, s.pixels);
    if (contrast_) {
        scatter_pes(s.marks, window_);
        contrast_->set_marks(s.marks);
    }
    for (std::size_t i = 0; i < counters_.size(); ++i) {
        scatter_pes(s.passes[i].cycles, window_);
        session_.write("resume", counters_[i].cycles, s.passes[i].cycles);
        scatter_pes(s.passes[i].events, RAYA_EVENTS);
        std::vector<std::uint64_t> counts(counters_[i].events.size());  // all events of a PE: in its first work-item
        for (std::size_t n = 0; n < s.passes[i].events.size(); ++n)
            counts[n / RAYA_EVENTS * RAYA_EVENTS * settings_.kernels.group_size + n % RAYA_EVENTS] =
                s.passes[i].events[n];
        session_.write("resume", counters_[i].events, counts);
        if (result.phases[i].recorded_cost) result.phases[i].recorded_cost->cycles = std::move(s.passes[i].costs);
    }
    if (result.all.recorded_cost) result.all.recorded_cost->cycles = std::move(s.all_costs);
}

}  // namespace raya
