#include "host/study/laboratory.hpp"

#include "host/ring/ring_renderer.hpp"
#include "host/scene/packer.hpp"
#include "host/study/arrays.hpp"

namespace raya {
namespace {

Costs render_costs(Session& session, const LabelledScene& scene, std::uint32_t size, AntialiasMethod method) {
    RingSettings settings;
    settings.machine = machine_named("grande");
    settings.format = format_for(scene.scene);
    settings.bounces = machine_named("spa").bounces;
    settings.mapping = cyclic(size, 16 % size);
    settings.antialias.method = method;
    settings.keep_costs = true;
    const RingResult result = RingRenderer(session, scene.scene, settings).render();
    Costs costs;
    costs.label = scene.label;
    costs.trace = result.phases.front().cost();
    if (method == AntialiasMethod::kSupersample) costs.supersample = result.phases.back().cost();
    costs.events = result.phases.front().events;
    costs.objects = scene.scene.object_count();
    costs.job_words = result.pe_memory.job_words;
    costs.recomputed = result.recomputed;
    costs.device_s = trace_seconds(result);
    return costs;
}

}  // namespace

NumberFormat format_for(const Scene& scene) {
    const Machine& spa = machine_named("spa");
    const JobSettings smallest{{1, 1}, Sampling::kCentres, spa.bounces, cycles_of_events(), spa.format};
    return 4 * pack_job(scene, smallest).words().size() <= spa.pe_memory_bytes.value() ? spa.format : NumberFormat{};
}

const Costs& Laboratory::costs(const LabelledScene& scene, std::uint32_t size, AntialiasMethod method) {
    for (const Known& known : known_)
        if (known.size == size && known.method == method && known.scene.label == scene.label &&
            known.scene.scene == scene.scene)
            return *known.costs;
    auto costs = std::make_unique<Costs>(render_costs(session_, scene, size, method));
    known_.push_back({scene, size, method, std::move(costs)});
    return *known_.back().costs;
}

double spa_ms(double cycles) { return cycles * machine_named("spa").cycle_ns.value() * 1e-6; }

}  // namespace raya
