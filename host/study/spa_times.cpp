#include "host/study/spa_times.hpp"

#include <fmt/core.h>

#include "host/machine/does_not_fit.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/paper.hpp"

namespace raya {
namespace {

SpaRun run_of(const RingSettings& settings, RingResult result) {
    SpaRun run;
    run.machine = settings.machine.name;
    for (Phase& phase : result.phases) {
        run.phases.push_back(std::move(phase.load));
        run.cost.push_back(std::move(phase.cost));
    }
    run.smoothing = smoothing_cycles(settings.antialias.method, largest_share(settings.mapping));
    run.communication = result.communication;
    run.pixels = std::uint64_t{settings.mapping.width} * settings.mapping.height;
    run.recomputed = result.recomputed;
    return run;
}

}  // namespace

SpaRun run_on_spa(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t pes,
                  std::uint32_t offset, AntialiasMethod method) {
    RingSettings settings;
    settings.machine = machine_named("spa");
    settings.format = format_for(scene.scene);
    settings.bounces = settings.machine.bounces;
    settings.mapping = cyclic(size, size, pes, offset);
    settings.antialias.method = method;
    try {
        return run_of(settings, RingRenderer(session, scene.scene, settings).render());
    } catch (const DoesNotFit&) {
        settings.machine = machine_named("grande");
        return run_of(settings, RingRenderer(session, scene.scene, settings).render());
    }
}

ModelledTime spa_time(const SpaRun& run, double factor) {
    return modelled_time(machine_named("spa"), run.phases, run.communication, factor, run.smoothing).value();
}

double fitted_factor(const CostImage& trace) {
    constexpr double kPaperPixelMs = paper::kOnePeComputeMs / (paper::kSize * paper::kSize);
    const auto pixels = static_cast<double>(trace.cycles.size());
    return kPaperPixelMs * pixels / spa_ms(static_cast<double>(total_cycles(trace)));
}

std::string offset_name(std::uint32_t offset) { return fmt::format("p = {}", offset); }

}  // namespace raya
