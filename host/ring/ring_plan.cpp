#include "host/ring/ring_plan.hpp"

#include <algorithm>

#include "host/accel/bvh.hpp"
#include "host/accel/partition.hpp"
#include "host/base/clock.hpp"
#include "host/cl/tuned.hpp"
#include "host/ring/mapping.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/bvh.h"

namespace raya {
namespace {

// Returns true if PEs should copy the job's words into local memory in each launch. Returns false if the words do not
// fit, or if the copying loop could exceed the device's limit of loop iterations. Also returns false for many words
// with an accelerator: the kernel then reads only a few of the words, so the copy takes longer than it saves.
bool words_local(const PackedJob& job, const DeviceInfo& device, AccelKind accel) {
    constexpr std::size_t kMaxCopiedBytes = 64 * 1024;
    constexpr std::size_t kMaxCopiedWords = 4096;
    if (device.max_loop_iterations > 0 && job.words().size() > kMaxCopiedWords) return false;
    // 32 bytes for padding to a multiple of 16 bytes, and for the work-group's own data.
    const std::size_t bytes = 4 * job.words().size() + 32;
    return bytes <= device.local_memory_bytes && (accel == AccelKind::kNone || bytes <= kMaxCopiedBytes);
}

constexpr std::size_t kTestsPerRay = 20;  // approximate number of object tests of a ray with an accelerator

// Returns the maximum work of a launch, in tests and traversal steps of a lane's rays, so that the device does not
// exceed its limit of loop iterations. A lane checks its work limit only after each ray and its shadow rays, so it may
// exceed the limit by the work `overrun`. The constants convert work to iterations. Measured with the images of `raya
// verify` on llvmpipe: 12 iterations per test were too few and 16 enough. A BVH step has one iteration for each of
// sixteen boxes and a few more. kIterationsPerLaunch is for the loop that copies words.
double max_launch_work(AccelKind accel, double overrun, const DeviceInfo& device) {
    constexpr double kIterationsPerTest = 24, kIterationsPerStep = 96, kIterationsPerLaunch = 8192;
    if (device.max_loop_iterations == 0) return 1u << 31;
    const double iterations = accel == AccelKind::kNone ? kIterationsPerTest : kIterationsPerStep;
    return std::max(1.0, (device.max_loop_iterations - kIterationsPerLaunch) / iterations - overrun);
}

PackedJob pack_in_span(const Session& session, const Scene& scene, const RingSettings& settings,
                       const LengthScale& scale) {
    const SpanLog::Span span = session.span("pack scene");
    return pack_for_ring(scene, settings, scale);
}

RingJob pack_ring_job(const Session& session, const Scene& scene, const RingSettings& settings,
                      const std::function<void()>& packed) {
    const LengthScale scale = length_scale(scene, settings.format);
    RingJob job{pack_in_span(session, scene, settings, scale), {}, 0, scale, scene.object_count()};
    if (packed) packed();
    if (settings.accel.kind == AccelKind::kNone) return job;
    const SpanLog::Span span = session.span("divide scene");
    const Clock::time_point start = Clock::now();
    job.accel = append_accel(job.job, settings);
    job.accel_s = seconds_since(start);
    return job;
}

// The members of a RingJob, other than the job's words, that rank 0 sends to other ranks.
struct RingFigures {
    AccelSummary accel;
    double accel_s = 0;
    LengthScale scale;
    std::uint64_t objects = 0;
    bool has_patches = false;
};

}  // namespace

void use_packets(RingSettings& settings, bool may_change_mapping) {
    if (settings.accel.kind != AccelKind::kBvh || !settings.format.is_fp32() || settings.dynamic) return;
    const raya_mapping& m = settings.mapping;
    if (may_change_mapping && settings.antialias.method == AntialiasMethod::kNone)
        for (const auto& [width, height] : {std::pair{4u, 4u}, {8u, 2u}, {2u, 8u}, {16u, 1u}})
            if (m.kind != RAYA_TILES && m.width % width == 0 && m.height % height == 0)
                settings.mapping = make_mapping(tiles_mapping(width, height), {m.width, m.height}, m.pes);
    settings.packets = m.kind == RAYA_TILES;
}

JobSettings job_settings(const RingSettings& settings, const LengthScale& scale) {
    return {{settings.mapping.width, settings.mapping.height},
            settings.sampling,
            settings.bounces,
            cycles_of_events(),
            settings.format,
            scale.exponent};
}

PeDemand pe_demand(const RingSettings& settings, const std::string& scene, std::uint64_t job_words) {
    return {.scene = scene,
            .job_words = job_words,
            .bounces = settings.bounces,
            .share_pixels = largest_share(settings.mapping),
            .antialias = settings.antialias.method};
}

RingSettings checked_settings(RingSettings settings, const DeviceInfo& device) {
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
                       std::size_t lights, std::uint32_t pes, const DeviceInfo& device) {
    if (const std::uint32_t work = settings.work_per_launch) return {work, work, work};
    constexpr double kTestsPerLaunch = 2e8;  // they take a quarter of a second on two CPU cores
    constexpr double kRaysPerPixel = 6;      // typical number
    const double tests_of_ray = static_cast<double>(
        settings.accel.kind != AccelKind::kNone ? std::min(kTestsPerRay, objects) : std::max<std::size_t>(1, objects));
    const double max = max_launch_work(settings.accel.kind, tests_of_ray * static_cast<double>(1 + lights), device);
    const double first = kTestsPerLaunch / (1.0 * pes * options.group_size * options.lanes);
    const auto bounded = [&](double work) { return static_cast<std::uint32_t>(std::clamp(work, 1.0, max)); };
    return {bounded(std::max(first, kRaysPerPixel * tests_of_ray)), bounded(kRaysPerPixel * tests_of_ray),
            bounded(max)};
}

KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, const AccelSummary& accel,
                             const DeviceInfo& device) {
    return {.lanes = settings.kernels.lanes,
            .group_size = settings.kernels.group_size,
            .bounces = settings.bounces,
            .format = settings.format,
            .exact_divide = settings.kernels.exact_arithmetic,
            .exact_fma = settings.kernels.exact_arithmetic,
            .words_local = settings.kernels.local_words && words_local(job, device, settings.accel.kind),
            .accel = static_cast<std::uint32_t>(settings.accel.kind),
            .stack = (RAYA_BVH_WIDTH - 1) * accel.depth,
            .filter = settings.kernels.filter && (job.header().objects.spheres > 0 || job.has_polygons()) &&
                      filters_are_valid(settings.format, job.header().extent),
            .polygons = job.has_polygons(),
            .patches = job.has_patches(),
            .cones = job.has_cones(),
            .packets = settings.packets,
            .tuning = settings.kernels.tuning};
}

PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale) {
    // More than most BVHs need. Without it, append_accel() would copy the job to other memory.
    constexpr std::size_t kBvhWordsPerObject = 20;
    JobSettings for_job = job_settings(settings, scale);
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
    if (!ranks.is_first()) {
        RingFigures figures;
        std::vector<std::uint32_t> words;
        ranks.broadcast(figures);
        ranks.broadcast(words);
        const auto header = record_at<raya_job>(words, 0);
        return {PackedJob(header, std::move(words), figures.has_patches), figures.accel, figures.accel_s, figures.scale,
                figures.objects};
    }
    RingJob job = pack_ring_job(session, scene, settings, packed);
    if (!ranks.has_several()) return job;
    const SpanLog::Span span = session.span("send scene");
    RingFigures figures{job.accel, job.accel_s, job.scale, job.objects, job.job.has_patches()};
    std::vector<std::uint32_t> words = job.job.words();
    ranks.broadcast(figures);
    ranks.broadcast(words);
    return job;
}

}  // namespace raya
