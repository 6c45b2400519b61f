#include "host/study/spa_times.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "host/model/does_not_fit.hpp"
#include "host/ring/route.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/paper.hpp"

namespace raya {
namespace {

SpaRun run_of(const RingSettings& settings, RingResult result) {
    SpaRun run;
    run.machine = settings.machine.name;
    for (Phase& phase : result.phases) {
        run.cost.push_back(phase.cost());
        run.phases.push_back(std::move(phase.load));
    }
    run.smoothing = smoothing_cycles(settings.antialias.method, largest_share(settings.mapping));
    run.communication = result.communication;
    run.pixels = std::uint64_t{settings.mapping.width} * settings.mapping.height;
    run.recomputed = result.recomputed;
    run.image = std::move(result.image);
    return run;
}

constexpr std::uint64_t kPixelWords = 3;

// One pass over the image: the imbalance of each offset.
struct Pass {
    double mean;  // cycles of a PE
    std::vector<double> imbalance;

    Pass(const CostImage& image, std::uint32_t pes, const std::vector<std::uint32_t>& offsets)
        : mean(static_cast<double>(total_cycles(image)) / pes),
          imbalance(imbalance_of_offsets(image, pes, RAYA_FOLD_CYCLIC, offsets)) {}
    double largest_ms(std::uint32_t offset) const { return spa_ms(mean * (1 + imbalance[offset])); }
};

}  // namespace

SpaRun run_on_spa(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t pes,
                  std::uint32_t offset, AntialiasMethod method) {
    RingSettings settings;
    settings.machine = machine_named("spa");
    settings.format = format_for(scene.scene);
    settings.bounces = settings.machine.bounces;
    settings.mapping = cyclic(size, size, pes, offset);
    settings.antialias.method = method;
    settings.keep_costs = true;
    try {
        return run_of(settings, RingRenderer(session, scene.scene, settings).render());
    } catch (const DoesNotFit&) {
        settings.machine = machine_named("grande");
        return run_of(settings, RingRenderer(session, scene.scene, settings).render());
    }
}

ModelledTime spa_time(const SpaRun& run, double factor) {
    ModelledTime time =
        modelled_time(machine_named("spa"), run.phases, run.communication, factor, run.smoothing).value();
    if (run.communication.rotations == 0) return time;
    time.communication_ms += paper::kExchangeSetupMs;
    time.total_ms += paper::kExchangeSetupMs;
    return time;
}

std::string offset_name(std::uint32_t offset) { return fmt::format("p = {}", offset); }

std::uint64_t neighbour_rotations(const raya_mapping& mapping) {
    raya_mapping short_one = mapping;
    // With slots of which no two PEs share one, the owner follows from the slot alone, and two rows show all pairs of
    // neighbouring slots that any number of rows does: for p > 0 their left borders lie in two slots, for p = 0 all in
    // one.
    if (raya_has_slots(mapping) && mapping.pes <= mapping.width) short_one.height = std::min(mapping.height, 2u);
    std::uint64_t turns = 0;
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side)
        for (const Leg& leg : shortest_route(mapping.pes, neighbour_distances(short_one, side))) turns += leg.turns();
    return turns;
}

std::vector<OffsetTime> offset_times(const Costs& costs, std::uint32_t pes, AntialiasMethod method, double factor) {
    const std::uint32_t width = costs.trace.width, height = costs.trace.height;
    const Machine& spa = machine_named("spa");
    std::vector<std::uint32_t> offsets(width);
    std::iota(offsets.begin(), offsets.end(), 0u);
    const Pass first(costs.trace, pes, offsets);
    std::optional<Pass> again;
    if (method == AntialiasMethod::kSupersample) again.emplace(costs.supersample, pes, offsets);
    std::vector<OffsetTime> times;
    for (const std::uint32_t p : offsets) {
        OffsetTime time{.offset = p, .imbalance = first.imbalance[p], .trace_ms = factor * first.largest_ms(p)};
        if (again) time.supersample_ms = factor * again->largest_ms(p);
        if (method != AntialiasMethod::kNone) {
            const raya_mapping mapping = cyclic(width, height, pes, p);
            const std::uint32_t share = largest_share(mapping);
            const SmoothingCycles cycles = smoothing_cycles(method, share);
            time.smooth_ms = factor * spa_ms(static_cast<double>(cycles.filter + cycles.compare));
            time.rotations = neighbour_rotations(mapping);
            const double words_ms = 1e3 * static_cast<double>(kPixelWords * share) / spa.link_words_per_s.value();
            time.ring_ms = paper::kExchangeSetupMs +
                           static_cast<double>(time.rotations) * (spa.rotation_sync_ms.value() + words_ms);
        }
        times.push_back(time);
    }
    return times;
}

SmoothingRuns SmoothingRuns::by_factor(double factor) const {
    SmoothingRuns other = *this;
    for (SmoothedOffset& row : other.rows) row.factor = factor;
    return other;
}

std::vector<OffsetTime> SmoothingRuns::near(double factor) const {
    std::vector<OffsetTime> some = times(factor);
    some.resize(std::min<std::size_t>(17, some.size()));
    return some;
}

SmoothingRuns smoothing_runs(Laboratory& lab, const Scenes& scenes, AntialiasMethod method) {
    SmoothingRuns study;
    study.scene = one_of(scenes);
    study.size = lab.size(256);
    study.method = method;
    for (const std::uint32_t p : {0u, 8u, 16u}) {
        const std::uint32_t offset = p % study.size;
        study.rows.push_back({offset, run_on_spa(lab.session(), study.scene, study.size, study.size, offset, method),
                              machine_factor().value});
    }
    const SpaRun& run = study.last().run;
    study.recomputed = static_cast<double>(run.recomputed) / static_cast<double>(run.pixels);
    study.costs.trace = run.cost.front();
    study.costs.supersample = run.cost.back();
    return study;
}

std::uint32_t usual_size(const Scene& scene) {
    constexpr std::uint64_t kMostTests = 1u << 30;  // pixels x objects
    constexpr std::uint32_t kOther = 256, kLeast = 64;
    const bool square = scene.view.width == scene.view.height && scene.view.width >= 16 && scene.view.width <= 4096;
    std::uint32_t size = square ? static_cast<std::uint32_t>(scene.view.width) : kOther;
    while (size / 2 >= kLeast && std::uint64_t{size} * size * scene.object_count() > kMostTests) size /= 2;
    return size;
}

}  // namespace raya
