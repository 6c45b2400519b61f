#include "host/ring/ring_plan.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/accel/bvh.hpp"
#include "host/accel/partition.hpp"
#include "host/base/log.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/mapping.hpp"
#include "kernels/shared/bvh.h"
#include "kernels/shared/part.h"

namespace raya {
namespace {

constexpr std::uint64_t kPendingRayWords = 7;  // a pending ray on the stack: origin, direction, weight
// State of a ray tree except the stack: ray, hit, normal, mirror direction, tint, sum, counters.
constexpr std::uint64_t kRayTreeWords = 32;
constexpr std::uint64_t kPixelBytes = 12;  // three colour components of 4 bytes
constexpr std::uint32_t kMaxTrees = 1024;  // of a PE with divided objects, so that the device's memory suffices

[[noreturn]] void refuse(const Machine& machine, const std::string& what, std::uint64_t bytes,
                         const std::string& remedy) {
    const char* memory_remedy = machine.name == "grande" ? "a larger --pe-memory, or none" : "--machine grande";
    throw DoesNotFit(
        fmt::format("{}: needs {} in every PE, a PE of {} has {}; use {}{}", what, required_size_text(bytes),
                    machine.title, available_size_text(*machine.pe_memory_bytes), remedy, memory_remedy),
        bytes, *machine.pe_memory_bytes);
}

// Returns true if PEs should copy their `words` words into local memory in each launch. Returns false if the words do
// not fit, or if the copying loop could exceed the device's limit of loop iterations. Also returns false for many words
// with an accelerator: the kernel then reads only a few of the words, so the copy takes longer than it saves.
bool words_local(std::size_t words, const DeviceInfo& device, AccelKind accel) {
    constexpr std::size_t kMaxCopiedBytes = 64 * 1024;
    constexpr std::size_t kMaxCopiedWords = 4096;
    if (device.ends_loops_early && words > kMaxCopiedWords) return false;
    // 32 bytes for padding to a multiple of 16 bytes, and for the work-group's own data.
    const std::size_t bytes = 4 * words + 32;
    return bytes <= device.local_memory_bytes && (accel == AccelKind::kNone || bytes <= kMaxCopiedBytes);
}

RingJob pack_ring_job(const Session& session, const Scene& scene, const RingSettings& settings,
                      const std::function<void()>& packed) {
    const LengthScale scale = length_scale(scene, settings.format);
    const auto pack = [&] {
        const SpanLog::Span span = session.span("pack scene");
        return pack_for_ring(scene, settings, scale);
    };
    RingJob job{{}, pack()};
    job.scale = scale;
    job.objects = scene.object_count();
    job.has_patches = job.job.has_patches();
    if (packed) packed();
    if (settings.accel.kind == AccelKind::kNone) return job;
    const SpanLog::Span span = session.span("divide scene");
    const Clock::time_point start = Clock::now();
    job.accel = append_accel(job.job, settings);
    job.accel_s = seconds_since(start);
    return job;
}

}  // namespace

PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand) {
    const bool divided = demand.parts > 1;
    PeMemory memory{
        .job_words = demand.job_words,
        .part_words = demand.part_words,
        .tree_words = divided ? raya_flight_words(demand.bounces) : kRayTreeWords + kPendingRayWords * demand.bounces};
    const bool antialiased = demand.antialias != AntialiasMethod::kNone;
    // The number of pixels that is reduced until the PE's memory suffices.
    std::uint32_t& fitted_pixels = antialiased ? memory.band_pixels : memory.block_pixels;
    if (antialiased) memory.block_pixels = demand.share_pixels;
    if (demand.antialias == AntialiasMethod::kFilter) memory.sum_pixels = demand.share_pixels;
    if (demand.antialias == AntialiasMethod::kSupersample) memory.marks = demand.share_pixels;
    const std::uint64_t fixed_bytes = memory.bytes();
    fitted_pixels = demand.share_pixels;
    const std::uint32_t max_trees = divided ? std::min(kMaxTrees, demand.share_pixels) : 1;
    if (!machine.pe_memory_bytes) {
        memory.trees = max_trees;
        return memory;
    }

    const std::uint64_t limit_bytes = *machine.pe_memory_bytes, tree_bytes = 4 * memory.tree_words;
    const std::string scene = divided ? fmt::format("{} in {} parts", demand.scene, demand.parts) : demand.scene;
    if (fixed_bytes + kPixelBytes > limit_bytes && antialiased)
        refuse(machine, fmt::format("{} with --antialias {}", scene, antialias_name(demand.antialias)),
               fixed_bytes + kPixelBytes, "more PEs, a smaller image or ");
    if (fixed_bytes + kPixelBytes > limit_bytes)
        refuse(machine, scene, fixed_bytes + kPixelBytes, demand.divisible ? "a larger --split or " : "");
    // The more ray trees are in flight, the fewer turns a render takes. They get half of the memory that is left, or
    // what the pixels leave.
    const std::uint64_t free_bytes = limit_bytes - fixed_bytes, for_pixels = divided ? free_bytes / 2 : free_bytes;
    fitted_pixels = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(demand.share_pixels, std::max<std::uint64_t>(1, for_pixels / kPixelBytes)));
    if (antialiased) {
        const std::uint32_t bands = (demand.share_pixels + fitted_pixels - 1) / fitted_pixels;
        fitted_pixels = (demand.share_pixels + bands - 1) / bands;
    }
    memory.trees =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(max_trees, 1 + (limit_bytes - memory.bytes()) / tree_bytes));
    return memory;
}

void use_packets(RingSettings& settings, bool may_change_mapping) {
    if (settings.accel.kind != AccelKind::kBvh || !settings.format.is_fp32() || settings.dynamic) return;
    const raya_mapping& m = settings.mapping;
    if (may_change_mapping && settings.antialias.method == AntialiasMethod::kNone)
        for (const auto& [width, height] : {std::pair{4u, 4u}, {8u, 2u}, {2u, 8u}, {16u, 1u}})
            if (m.kind != RAYA_TILES && m.width % width == 0 && m.height % height == 0)
                settings.mapping = make_mapping(tiles_mapping(width, height), {m.width, m.height}, m.pes);
    settings.packets = m.kind == RAYA_TILES;
}

PeDemand pe_demand(const RingSettings& settings, const std::string& scene, std::uint64_t job_words) {
    return {.scene = scene,
            .job_words = job_words,
            .bounces = settings.bounces,
            .share_pixels = largest_share(settings.mapping),
            .antialias = settings.antialias.method};
}

void check_split(const RingSettings& settings) {
    const std::uint32_t parts = settings.split, pes = settings.mapping.pes;
    if (parts <= 1) return;
    std::uint32_t divisor = std::min(parts, pes);
    while (pes % divisor != 0) --divisor;
    if (divisor != parts)
        throw UserError(
            fmt::format("--split {}: must divide the number of PEs, {}; use --split {}", parts, pes, divisor));
    if (settings.accel.kind != AccelKind::kNone)
        throw UserError(
            fmt::format("--split {} with --accel {}: parts have no acceleration structure; leave out one "
                        "of them, or use --accel none",
                        parts, accel_text(settings.accel)));
    if (settings.dynamic)
        throw UserError(
            fmt::format("--split {} with a dynamic mapping: PEs that wait for each other after each part "
                        "cannot request pixels at any time; leave out one of them",
                        parts));
}

RingSettings checked_settings(RingSettings settings, const DeviceInfo& device) {
    check_split(settings);
    check_antialias(settings.antialias.method, settings.mapping, settings.dynamic.has_value());
    settings.kernels =
        chosen_kernels(settings.kernels, device,
                       {.accel = static_cast<std::uint32_t>(settings.accel.kind), .fp32 = settings.format.is_fp32()},
                       settings.mapping.pes);
    check_kernel_options(
        {.lanes = settings.kernels.lanes, .group_size = settings.kernels.group_size, .bounces = settings.bounces},
        device);
    return settings;
}

LaunchWork launch_work(const RingSettings& settings, const KernelOptions& options, std::size_t objects,
                       std::uint32_t pes) {
    if (const std::uint32_t work = settings.work_per_launch) return {work, work, 0};
    constexpr double kTestsPerLaunch = 2e8;   // they take a quarter of a second on two CPU cores
    constexpr std::size_t kTestsPerRay = 20;  // approximate number of object tests of a ray with an accelerator
    constexpr double kRaysPerPixel = 6, kMaxWork = 1u << 31;  // typical number of rays
    const double least = kRaysPerPixel * static_cast<double>(settings.accel.kind != AccelKind::kNone
                                                                 ? std::min(kTestsPerRay, objects)
                                                                 : std::max<std::size_t>(1, objects));
    const double first = kTestsPerLaunch / (1.0 * pes * options.group_size * options.lanes);
    const auto bounded = [&](double work) { return static_cast<std::uint32_t>(std::clamp(work, 1.0, kMaxWork)); };
    return {bounded(std::max(first, least)), bounded(least)};
}

KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, std::size_t pe_words,
                             const AccelSummary& accel, const DeviceInfo& device) {
    KernelOptions options = kernel_options(settings, job.header(), job.has_patches());
    options.words_local = options.words_local && words_local(pe_words, device, settings.accel.kind);
    options.accel = static_cast<std::uint32_t>(settings.accel.kind);
    options.stack = (RAYA_BVH_WIDTH - 1) * ((accel.depth + 2) / 3 * 3);  // for a multiple of 3 levels: fewer builds
    options.packets = settings.packets;
    return options;
}

PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale) {
    // More than most BVHs need. Without it, append_accel() would copy the job to other memory.
    constexpr std::size_t kBvhWordsPerObject = 20;
    JobSettings for_job{{settings.mapping.width, settings.mapping.height},
                        settings.sampling,
                        settings.bounces,
                        cycles_of_events(),
                        settings.format,
                        scale.exponent};
    if (settings.accel.kind == AccelKind::kBvh) for_job.spare_words = kBvhWordsPerObject * scene.object_count();
    PackedJob job = pack_job(scene, for_job);
    raya_job header = job.header();
    header.mapping = settings.mapping;
    job.set_header(header);
    return job;
}

AccelSummary append_accel(PackedJob& job, const RingSettings& settings) {
    return settings.accel.kind == AccelKind::kBvh
               ? append_bvh(job, settings.format)
               : append_grid(job, accel_partition(job, settings.format, settings.accel));
}

RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks,
                      const std::function<void()>& packed) {
    std::optional<RingJob> job;
    if (ranks.is_first()) job = pack_ring_job(session, scene, settings, packed);
    if (!ranks.has_several()) return *std::move(job);
    const SpanLog::Span span = session.span("send scene");
    JobFigures figures = job ? *job : JobFigures{};
    std::vector<std::uint32_t> words = job ? job->job.words() : std::vector<std::uint32_t>();
    ranks.broadcast(figures);
    ranks.broadcast(words);
    if (job) return *std::move(job);
    const auto header = record_at<raya_job>(words, 0);
    return {figures, PackedJob(header, std::move(words), figures.has_patches)};
}

SampleTracer::SampleTracer(Kernels& kernels, std::string build_options, const Distribution& pes, std::uint32_t capacity)
    : session_(kernels.session()),
      options_(kernels.options()),
      build_options_(std::move(build_options)),
      pes_(pes),
      capacity_(capacity),
      progress_(session_.buffer<raya_trace_progress>("progress", pes.count())) {}

Tracer::Tracer(Kernels& kernels, const Distribution& pes, std::uint32_t capacity, const LaunchWork& work)
    : SampleTracer(kernels, kernels.program(TraceKernel::kFile).options(), pes, capacity),
      work_(work),
      kernel_(kernels.get<TraceKernel>()),
      saved_trees_(session_.buffer<std::uint32_t>(
          "saved trees",
          std::size_t{pes.count()} * options_.group_size * options_.lanes * raya_saved_words(options_.bounces))) {}

PassCounters SampleTracer::make_counters(const std::string& pass) const {
    const std::size_t costs = options_.packets ? 1 : std::size_t{pes_.count()} * capacity_;  // else not counted
    return {session_.buffer<std::uint64_t>("pixel cycles of " + pass, costs),
            session_.buffer<std::uint64_t>("events of " + pass,
                                           std::size_t{pes_.count()} * options_.group_size * RAYA_EVENTS)};
}

void SampleTracer::clear(PassCounters& counters) {
    session_.write("clear counters", counters.events, std::vector<std::uint64_t>(counters.events.size()));
    session_.fill("clear counters", counters.cycles, 0);
    counters.turn_cycles.clear();
}

void Tracer::warm_up(const TracePass& pass) {
    reset_progress(pass);
    launch(pass, 1);
}

void Tracer::trace(const TracePass& pass, const ProgressCallback& progress) {
    reset_progress(pass);
    launches_.run(
        session_, pass.label, progress ? work_.with_progress : work_.first, work_.target_s / (progress ? 2 : 1),
        [&](std::uint32_t work, bool) { launch(pass, work); }, [&] { return read_progress(pass, progress); }, progress_,
        saved_trees_, pass.pixels, pass.counters.cycles, pass.counters.events);
}

LaunchEnd SampleTracer::read_progress(const TracePass& pass, const ProgressCallback& progress) {
    const auto [window_start, begin, end] = pass.range;
    std::vector<raya_trace_progress> pes(pes_.count());
    session_.read(pass.label, progress_, pes);
    LaunchEnd ended;
    std::uint64_t traced = 0;
    for (const raya_trace_progress& pe : pes) {
        ended.done &= pe.left == 0;
        ended.truncated |= pe.cut > 0;
        traced += pe.next - begin;
    }
    if (progress && !ended.truncated)
        progress(ended.done ? 1 : static_cast<double>(traced) / (1.0 * pes_.count() * (end - begin)));
    return ended;
}

// Writes the buffer instead of filling it, because Oclgrind reports filled buffers as uninitialised.
void SampleTracer::reset_progress(const TracePass& pass) {
    session_.write(pass.label, progress_, std::vector<raya_trace_progress>(pes_.count(), {pass.range.begin, 0, 0}));
}

void Tracer::launch(const TracePass& pass, std::uint32_t work) {
    const std::size_t words = pass.job.size();
    session_.launch(pass.label, kernel_, pes_.count(), options_.group_size, pass.job,
                    Uint<"word_count">{cl_uint(words)}, Uint<"window_start">{pass.range.window_start},
                    Uint<"capacity">{capacity_}, Uint<"end">{pass.range.end}, Uint<"points">{pass.points},
                    Uint<"first_pe">{pes_.first()}, Uint<"work">{work}, pass.marks, LocalMemory<raya_trace_progress>{1},
                    LocalMemory<std::uint32_t>{options_.words_local ? (words + 3) / 4 * 4 : 4}, pass.pixels,
                    pass.counters.cycles, pass.counters.events, progress_, saved_trees_);
}

}  // namespace raya
