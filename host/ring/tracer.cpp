#include "host/ring/tracer.hpp"

#include <algorithm>

namespace raya {

Tracer::Tracer(Kernels& kernels, std::uint32_t pes, std::uint32_t capacity, std::uint32_t slice)
    : session_(kernels.session()),
      options_(kernels.options()),
      pes_(pes),
      capacity_(capacity),
      slice_(slice),
      build_options_(kernels.program(TraceKernel::kFile).options()),
      kernel_(kernels.get<TraceKernel>()) {}

PassCounters Tracer::make_counters(const std::string& pass) const {
    return {session_.buffer<std::uint64_t>("pixel cycles of " + pass, std::size_t{pes_} * capacity_),
            session_.buffer<std::uint64_t>("events of " + pass, std::size_t{pes_} * options_.group_size * RAYA_EVENTS)};
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
    for (std::uint32_t begin = range.begin; begin < range.end; begin += slice_) {
        const std::uint32_t end = std::min(range.end, begin + slice_);
        launch(label, job, {range.block, begin, end}, points, marks, pixels, counters);
        if (!progress) continue;
        session_.finish();
        progress(static_cast<double>(end - range.begin) / (range.end - range.begin));
    }
}

void Tracer::launch(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                    const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters) {
    const LocalMemory<std::uint32_t> memory{1 + (options_.words_local ? job.size() : 0)};
    session_.launch(label, kernel_, pes_, options_.group_size, job, Uint<"word_count">{cl_uint(job.size())},
                    Uint<"block">{range.block}, Uint<"capacity">{capacity_}, Uint<"begin">{range.begin},
                    Uint<"end">{range.end}, Uint<"points">{points}, marks, memory, pixels, counters.cycles,
                    counters.events);
}

}  // namespace raya
