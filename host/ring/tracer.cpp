#include "host/ring/tracer.hpp"

#include <algorithm>

#include "host/base/clock.hpp"

namespace raya {
namespace {

// Returns the work with which the next launch takes about `target_s` seconds. `work`: work of the last launch, which
// took `seconds`; `max`: maximum of the result. The work grows at most by a factor of kMaxGrowth.
std::uint32_t next_work(std::uint32_t work, std::uint32_t max, double seconds, double target_s) {
    constexpr double kMaxGrowth = 4;
    const double growth = seconds * kMaxGrowth > target_s ? target_s / seconds : kMaxGrowth;
    return static_cast<std::uint32_t>(std::clamp(growth * work, 1.0, 1.0 * max));
}

std::size_t saved_tree_words(const KernelOptions& options, std::uint32_t pes) {
    const std::size_t lanes = std::size_t{pes} * options.group_size * options.lanes;
    return lanes * raya_saved_words(trees_of(options), options.bounces);
}

}  // namespace

Tracer::Tracer(Kernels& kernels, const PeSegment& pes, std::uint32_t capacity, const LaunchWork& work)
    : session_(kernels.session()),
      options_(kernels.options()),
      pes_(pes),
      capacity_(capacity),
      work_(work),
      build_options_(kernels.program(TraceKernel::kFile).options()),
      kernel_(kernels.get<TraceKernel>()),
      progress_(session_.buffer<raya_trace_progress>("progress", pes.count)),
      saved_trees_(session_.buffer<std::uint32_t>("saved trees", saved_tree_words(options_, pes.count))) {}

PassCounters Tracer::make_counters(const std::string& pass) const {
    const std::size_t costs = options_.packets ? 1 : std::size_t{pes_.count} * capacity_;  // else not counted
    return {session_.buffer<std::uint64_t>("pixel cycles of " + pass, costs),
            session_.buffer<std::uint64_t>("events of " + pass,
                                           std::size_t{pes_.count} * options_.group_size * RAYA_EVENTS)};
}

void Tracer::clear(PassCounters& counters) {
    session_.write("clear counters", counters.events, std::vector<std::uint64_t>(counters.events.size()));
    session_.fill("clear counters", counters.cycles, 0);
}

void Tracer::warm_up(const Buffer<std::uint32_t>& job, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels,
                     PassCounters& counters) {
    reset_progress("warm-up", 0);
    launch("warm-up", job, {}, RAYA_POINTS_OWN, 1, marks, pixels, counters);
}

void Tracer::trace(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                   const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters,
                   const ProgressCallback& progress, const std::function<void()>& host_work) {
    const double target_s = progress ? 0.5 : 1.0;
    std::uint32_t work = progress ? work_.with_progress : work_.first;
    reset_progress(label, range.begin);
    for (bool first = true, done = false; !done; first = false) {
        work = guard_.begin(session_, label, work, progress_, saved_trees_, pixels, counters.cycles, counters.events);
        const Clock::time_point start = Clock::now();
        launch(label, job, range, points, work, marks, pixels, counters);
        if (first && host_work) {
            session_.flush();
            host_work();
        }
        const State state = read_state(label);
        if (state.truncated) {
            guard_.restore_state(session_, label,
                                 "fewer tests of a ray (--accel bvh or grid), other --lanes or --group", progress_,
                                 saved_trees_, pixels, counters.cycles, counters.events);
            continue;
        }
        done = state.done;
        work = next_work(work, work_.max, seconds_since(start), target_s);
        if (!progress) continue;
        const double all_pixels = 1.0 * pes_.count * (range.end - range.begin),
                     earlier_pixels = 1.0 * pes_.count * range.begin;
        progress(done ? 1.0 : (static_cast<double>(state.next_pixels) - earlier_pixels) / all_pixels);
    }
}

// Writes the buffer instead of filling it, because Oclgrind reports filled buffers as uninitialised.
void Tracer::reset_progress(const std::string& label, std::uint32_t pixel) {
    session_.write(label, progress_, std::vector<raya_trace_progress>(pes_.count, {pixel, 0, 0}));
}

Tracer::State Tracer::read_state(const std::string& label) {
    std::vector<raya_trace_progress> pes(pes_.count);
    session_.read(label, progress_, pes);
    State state{.done = true};
    for (const raya_trace_progress& pe : pes) {
        state.done &= pe.left == 0;
        state.next_pixels += pe.next;
        state.truncated |= pe.cut > 0;
    }
    return state;
}

void Tracer::launch(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                    std::uint32_t work, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels,
                    PassCounters& counters) {
    session_.launch(label, kernel_, pes_.count, options_.group_size, job, Uint<"word_count">{cl_uint(job.size())},
                    Uint<"window_start">{range.window_start}, Uint<"capacity">{capacity_}, Uint<"end">{range.end},
                    Uint<"points">{points}, Uint<"first_pe">{pes_.first}, Uint<"work">{work}, marks,
                    LocalMemory<raya_trace_progress>{1},
                    LocalMemory<std::uint32_t>{options_.words_local ? (job.size() + 3) / 4 * 4 : 4}, pixels,
                    counters.cycles, counters.events, progress_, saved_trees_);
}

}  // namespace raya
