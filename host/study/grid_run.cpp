#include "host/study/grid_run.hpp"

#include <algorithm>

#include "host/model/machine.hpp"
#include "host/model/t805.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/study/arrays.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

constexpr double kEnoughS = 1;  // of timing one grid

RingSettings ring_settings(const Divisions& divisions, const GridSettings& settings) {
    RingSettings ring;
    ring.machine = machine_named("grande");
    ring.mapping = cyclic(settings.side, settings.side, 1, 0);
    ring.bounces = settings.bounces;
    ring.sampling = settings.sampling;
    ring.accel = {.kind = AccelKind::kGrid, .divisions = divisions};
    return ring;
}

}  // namespace

GridRun run_grid(Session& session, const LabelledScene& scene, const Divisions& divisions,
                 const GridSettings& settings) {
    const RingSettings ring = ring_settings(divisions, settings);
    RingRenderer renderer(session, scene.scene, ring);
    GridRun run{.label = scene.label, .objects = scene.scene.object_count(), .divisions = divisions};
    const RingResult counted = renderer.render();  // a warm-up for those that are timed
    run.events = counted.all.events;
    run.copies = counted.accel->copies;
    const Measured time = measure(settings.runs, kEnoughS,
                                  [&] { return sample_seconds([&] { return trace_seconds(renderer.render()); }); });
    run.measured_ms = time.min_ms;
    run.median_ms = time.median_ms;
    return run;
}

std::string GridRun::sides() const { return sides_text(divisions); }

double t805_ms(const EventCounts& events) {
    constexpr double kMsPerNs = 1e-6;
    const auto cycles = t805_cycles();
    std::uint64_t sum = 0;
    for (std::size_t event = 0; event < cycles.size(); ++event) sum += cycles[event] * events[event];
    return static_cast<double>(sum) * kT805CycleNs * kMsPerNs;
}

}  // namespace raya
