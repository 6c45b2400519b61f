#include "host/ring/ring_job.hpp"

#include <chrono>

#include "host/accel/grid.hpp"
#include "host/accel/tree_words.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/word_records.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

PackedJob packed(const Session& session, const Scene& scene, const RingSettings& settings, const LengthScale& scale) {
    const StepLog::Step step = session.step("pack scene");
    return pack_for_ring(scene, settings, scale);
}

RingJob pack_ring_job(const Session& session, const Scene& scene, const RingSettings& settings) {
    const LengthScale scale = length_scale(scene, settings.format);
    RingJob all{packed(session, scene, settings, scale), {}, 0, scale, scene.object_count()};
    if (settings.accel.kind == AccelKind::kNone) return all;
    const StepLog::Step step = session.step("divide scene");
    const Clock::time_point start = Clock::now();
    all.accel = append_accel(all.job, settings);
    all.accel_s = std::chrono::duration<double>(Clock::now() - start).count();
    return all;
}

// All of a job but its words.
struct Figures {
    AccelSummary accel;
    double accel_s = 0;
    LengthScale scale;
    std::uint64_t objects = 0;
    bool has_patches = false;
};

}  // namespace

PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale) {
    PackedJob job = pack_job(scene, job_settings(settings, scale));
    raya_job on_ring = job.header();
    on_ring.mapping = settings.mapping;
    job.set_header(on_ring);
    return job;
}

AccelSummary append_accel(PackedJob& job, const RingSettings& settings) {
    return settings.accel.kind == AccelKind::kBvh
               ? append_tree(job, settings.format)
               : append_grid(job, accel_partition(job, settings.format, settings.accel));
}

RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks) {
    if (!ranks.first()) {
        Figures f;
        std::vector<std::uint32_t> words;
        ranks.broadcast(f);
        ranks.broadcast(words);
        const auto header = record_at<raya_job>(words, 0);
        return {PackedJob(header, std::move(words), f.has_patches), f.accel, f.accel_s, f.scale, f.objects};
    }
    RingJob all = pack_ring_job(session, scene, settings);
    if (!ranks.many()) return all;
    const StepLog::Step step = session.step("send scene");
    Figures f{all.accel, all.accel_s, all.scale, all.objects, all.job.has_patches()};
    std::vector<std::uint32_t> words = all.job.words();
    ranks.broadcast(f);
    ranks.broadcast(words);
    return all;
}

}  // namespace raya
