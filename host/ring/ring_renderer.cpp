#include "ring/ring_renderer.hpp"

#include <algorithm>
#include <chrono>

#include "cl/kernel_source.hpp"
#include "ring/kernel_options.hpp"
#include "ring/mapping.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

JobSettings job_settings(const RingSettings& settings) {
    return {settings.mapping, settings.sampling, settings.bounces, cycles_of_events(), settings.format};
}

// The settings with lanes and group size chosen, refused before anything is packed or taken if the kernels cannot be
// built with them.
RingSettings checked(RingSettings settings, const DeviceInfo& device) {
    if (!settings.kernels.lanes) settings.kernels.lanes = default_lanes(device);
    if (!settings.kernels.group_size) settings.kernels.group_size = default_group_size(device);
    check_kernel_options(
        {.lanes = settings.kernels.lanes, .group_size = settings.kernels.group_size, .bounces = settings.bounces},
        device);
    return settings;
}

// Pixels of each share to trace in one launch. A launch should last no longer than about a second, so that a progress
// bar moves, Ctrl-C is heard and a GPU's watchdog sleeps; and it should give each lane several pixels, so that few wait
// for the last.
std::uint32_t slice_pixels(const RingSettings& settings, std::size_t objects, std::uint32_t lanes,
                           std::uint32_t share) {
    if (settings.pixels_per_launch) return settings.pixels_per_launch;
    constexpr double kTestsPerLaunch = 1e9;  // about a second of two CPU cores
    constexpr double kRaysPerPixel = 6;      // of the project's scenes
    const double tests_of_one = kRaysPerPixel * static_cast<double>(objects) * settings.mapping.pes;
    const auto affordable = static_cast<std::uint32_t>(std::min(kTestsPerLaunch / tests_of_one, double(share)));
    return std::clamp(affordable, std::min(8 * lanes, share), share);
}

}  // namespace

double trace_seconds(const RingResult& result) {
    double ns = 0;
    for (const LabelSummary& command : result.commands)
        if (command.label == "trace") ns += static_cast<double>(command.total_ns);
    return ns > 0 ? ns * 1e-9 : result.render_s;
}

RingRenderer::RingRenderer(Session& session, const Scene& scene, const RingSettings& settings)
    : session_(session),
      settings_(checked(settings, session.device())),
      filter_(settings.kernels.filter && !scene.spheres.empty() &&
              sphere_filter_holds(settings.format, scene_extent(scene))),
      job_(pack_job(scene, job_settings(settings))),
      share_(largest_share(settings.mapping)),
      memory_(plan_pe_memory(settings.machine, scene.name, job_.words.size(), settings.bounces, share_)),
      slice_(slice_pixels(settings, scene.object_count(), settings_.kernels.lanes * settings_.kernels.group_size,
                          memory_.block_pixels)),
      words_local_(4 * job_.words.size() + sizeof(cl_uint) <= session.device().local_memory_bytes),
      bus_(session, communication_),
      broadcast_(session.buffer<std::uint32_t>("broadcast words", job_.words.size())),
      pixels_(session.buffer<float>("pixel blocks", 3ull * settings.mapping.pes * memory_.block_pixels)),
      cycles_(session.buffer<std::uint64_t>("pixel cycles", 1ull * settings.mapping.pes * memory_.block_pixels)),
      events_(session.buffer<std::uint64_t>("events",
                                            1ull * settings.mapping.pes * settings_.kernels.group_size * RAYA_EVENTS)) {
    build();
}

void RingRenderer::build() {
    const KernelOptions options{.lanes = settings_.kernels.lanes,
                                .group_size = settings_.kernels.group_size,
                                .bounces = settings_.bounces,
                                .format = settings_.format,
                                .words_local = words_local_,
                                .filter = filter_,
                                .polygons = job_.has_polygons,
                                .patches = job_.has_patches,
                                .cones = job_.has_cones};
    std::vector<std::string> all = build_options(options, session_.device());
    all.insert(all.end(), settings_.kernels.more_options.begin(), settings_.kernels.more_options.end());
    const Clock::time_point start = Clock::now();
    const Program program =
        session_.build("ring/trace.cl", kernel_source("ring/trace.cl", settings_.kernels.kernel_dir), all);
    trace_ = std::make_unique<TraceKernel>(
        program.kernel<const Buffer<std::uint32_t>&, cl_uint, cl_uint, cl_uint, cl_uint, cl_uint,
                       LocalMemory<std::uint32_t>, Buffer<float>&, Buffer<std::uint64_t>&, Buffer<std::uint64_t>&>(
            "trace"));
    build_options_ = program.options();
    // PoCL compiles a kernel's body at its first launch: launch it once for no pixels, so that this counts as building.
    session_.write("clear counters", events_, std::vector<std::uint64_t>(events_.size()));
    bus_.broadcast(broadcast_, job_.words);
    launch_trace("warm-up", 0, 0, 0);
    session_.finish();
    build_s_ = seconds_since(start);
}

void RingRenderer::launch_trace(const std::string& label, std::uint32_t block, std::uint32_t begin, std::uint32_t end) {
    const LocalMemory<std::uint32_t> memory{words_local_ ? job_.words.size() : 1};
    session_.launch(label, *trace_, settings_.mapping.pes, settings_.kernels.group_size, broadcast_,
                    static_cast<cl_uint>(job_.words.size()), block, memory_.block_pixels, begin, end, memory, pixels_,
                    cycles_, events_);
}

RingResult RingRenderer::render(const ProgressCallback& progress) {
    session_.clear_profile();
    communication_ = {};
    const Clock::time_point start = Clock::now();
    RingResult result;
    prepare(result);
    bus_.broadcast(broadcast_, job_.words);
    for (std::uint32_t block = 0; block < share_; block += memory_.block_pixels) {
        trace(block, progress);
        gather(block, result);
    }
    collect_events(result);
    result.render_s = seconds_since(start);
    describe(result);
    return result;
}

void RingRenderer::prepare(RingResult& result) {
    const raya_mapping& m = settings_.mapping;
    const std::size_t pixels = std::size_t{m.width} * m.height;
    result.image = {static_cast<int>(m.width), static_cast<int>(m.height), std::vector<float>(3 * pixels)};
    result.cost = {static_cast<int>(m.width), static_cast<int>(m.height), std::vector<float>(pixels)};
    session_.write("clear counters", events_, std::vector<std::uint64_t>(events_.size()));
}

void RingRenderer::trace(std::uint32_t block, const ProgressCallback& progress) {
    const std::uint32_t end = std::min(share_, block + memory_.block_pixels);
    for (std::uint32_t begin = block; begin < end; begin += slice_) {
        const std::uint32_t until = std::min(end, begin + slice_);
        launch_trace("trace", block, begin, until);
        if (!progress) continue;
        session_.finish();
        progress(static_cast<double>(until) / share_);
    }
}

void RingRenderer::gather(std::uint32_t block, RingResult& result) {
    const raya_mapping& m = settings_.mapping;
    const std::size_t capacity = memory_.block_pixels;
    std::vector<float> pixels(3 * capacity * m.pes);
    std::vector<std::uint64_t> cycles(capacity * m.pes);
    std::uint64_t owned = 0;
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const std::uint32_t share = raya_share_size(raya_share_of(m, pe));
        owned += share > block ? std::min<std::uint64_t>(share - block, capacity) : 0;
    }
    bus_.gather(pixels_, pixels, 3 * owned);
    session_.read("read cost", cycles_, cycles);
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const raya_share share = raya_share_of(m, pe);
        const std::uint32_t end = std::min(raya_share_size(share), block + memory_.block_pixels);
        for (std::uint32_t k = block; k < end; ++k) {
            const raya_pixel at = raya_pixel_of(m, share, k);
            const std::size_t to = std::size_t{at.row} * m.width + at.column, from = pe * capacity + (k - block);
            std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(3 * from), 3,
                        result.image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * to));
            result.cost.values[to] = static_cast<float>(cycles[from]);
        }
    }
}

void RingRenderer::collect_events(RingResult& result) {
    std::vector<std::uint64_t> counted(events_.size());
    session_.read("read counters", events_, counted);
    const auto cycles = cycles_of_events();
    std::vector<std::uint64_t> loads(settings_.mapping.pes);
    for (std::size_t i = 0; i < counted.size(); ++i) {
        const std::size_t event = i % RAYA_EVENTS;
        result.events[event] += counted[i];
        loads[i / RAYA_EVENTS / settings_.kernels.group_size] += cycles[event] * counted[i];
    }
    result.load = load_of(std::move(loads));
}

void RingRenderer::describe(RingResult& result) {
    result.communication = communication_;
    result.pe_memory = memory_;
    result.lanes = settings_.kernels.lanes;
    result.group_size = settings_.kernels.group_size;
    result.build_options = build_options_;
    result.build_s = build_s_;
    result.commands = session_.profile().summary();
}

}  // namespace raya
