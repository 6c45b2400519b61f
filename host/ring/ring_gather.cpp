// Collection of the results of all ranks' PEs in rank 0: pixels, costs, marks, counters.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>

#include "host/base/parallel.hpp"
#include "host/error.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/ring_renderer.hpp"
#include "kernels/shared/share_pixels.h"

namespace raya {
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
