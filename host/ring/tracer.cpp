#include "host/ring/tracer.hpp"

#include <algorithm>
#include <chrono>

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

// After one of `slice` pixels that took `seconds`.
std::uint32_t next_slice(const LaunchSlices& slices, std::uint32_t slice, double seconds) {
    constexpr double kSeconds = 0.5, kMostGrowth = 4;
    const double growth = seconds * kMostGrowth > kSeconds ? kSeconds / seconds : kMostGrowth;
    return std::clamp(static_cast<std::uint32_t>(std::min(growth * slice, 1.0 * slices.most)), slices.least,
                      slices.most);
}

}  // namespace

Tracer::Tracer(Kernels& kernels, const PeSegment& pes, std::uint32_t capacity, const LaunchSlices& slices)
    : session_(kernels.session()),
      options_(kernels.options()),
      pes_(pes),
      capacity_(capacity),
      slices_(slices),
      build_options_(kernels.program(TraceKernel::kFile).options()),
      kernel_(kernels.get<TraceKernel>()) {}

PassCounters Tracer::make_counters(const std::string& pass) const {
    return {session_.buffer<std::uint64_t>("pixel cycles of " + pass, std::size_t{pes_.count} * capacity_),
            session_.buffer<std::uint64_t>("events of " + pass,
                                           std::size_t{pes_.count} * options_.group_size * RAYA_EVENTS)};
}

void Tracer::clear(PassCounters& counters) {
    session_.write("clear counters", counters.events, std::vector<std::uint64_t>(counters.events.size()));
    session_.fill("clear counters", counters.cycles, 0);
}

void Tracer::warm_up(const Buffer<std::uint32_t>& job, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels,
                     PassCounters& counters) {
    launch("warm-up", job, {}, RAYA_POINTS_OWN, marks, pixels, counters);
}

void Tracer::trace(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                   const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters,
                   const ProgressCallback& progress) {
    std::uint32_t slice = progress ? slices_.first : slices_.most;
    for (std::uint32_t begin = range.begin, end; begin < range.end; begin = end) {
        end = begin + std::min(range.end - begin, slice);
        const Clock::time_point start = Clock::now();
        launch(label, job, {range.block, begin, end}, points, marks, pixels, counters);
        if (!progress) continue;
        session_.finish();
        progress(static_cast<double>(end - range.begin) / (range.end - range.begin));
        slice = next_slice(slices_, slice, std::chrono::duration<double>(Clock::now() - start).count());
    }
}

void Tracer::launch(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                    const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters) {
    const LocalMemory<std::uint32_t> memory{1 + (options_.words_local ? job.size() : 0)};
    session_.launch(label, kernel_, pes_.count, options_.group_size, job, Uint<"word_count">{cl_uint(job.size())},
                    Uint<"block">{range.block}, Uint<"capacity">{capacity_}, Uint<"begin">{range.begin},
                    Uint<"end">{range.end}, Uint<"points">{points}, Uint<"first_pe">{pes_.first}, marks, memory, pixels,
                    counters.cycles, counters.events);
}

}  // namespace raya
