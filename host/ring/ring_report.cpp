#include "host/ring/ring_report.hpp"

#include <fmt/core.h>

#include "host/model/budget.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/mapping.hpp"

namespace raya {
namespace {

double recomputed_share(const RingResult& result) {
    return static_cast<double>(result.recomputed) / (1.0 * result.image.width * result.image.height);
}

Json antialias_json(const RingSettings& settings, const RingResult& result) {
    const Antialias& a = settings.antialias;
    Json json = {{"method", antialias_name(a.method)}};
    if (a.method == AntialiasMethod::kNone) return json;
    json["exchange"] = exchange_name(a.exchange);
    json["band_pixels"] = result.pe_memory.band_pixels;
    if (a.method == AntialiasMethod::kFilter) return json;
    json["threshold"] = a.threshold;
    json["points"] = points_name(a.points);
    json["recomputed_pixels"] = result.recomputed;
    json["recomputed_share"] = recomputed_share(result);
    return json;
}

Json communication_json(const Communication& c) {
    return {{"broadcasts", c.broadcasts},
            {"broadcast_words", c.broadcast_words},
            {"rotations", c.rotations},
            {"rotation_words", c.rotation_words},
            {"transfers", c.transfers},
            {"transfer_words", c.transfer_words},
            {"pe_broadcasts", c.pe_broadcasts},
            {"pe_broadcast_words", c.pe_broadcast_words},
            {"gathers", c.gathers},
            {"gather_words", c.gather_words}};
}

Json accel_json(const std::optional<AccelSummary>& a) {
    if (!a) return {{"kind", "none"}};
    if (a->kind == AccelKind::kBvh)
        return {{"kind", "bvh"},     {"nodes", a->nodes}, {"leaves", a->leaves},
                {"depth", a->depth}, {"words", a->words}, {"apart", a->separate}};
    return {{"kind", "grid"},
            {"divisions", a->divisions},
            {"copies", a->copies},
            {"words", a->words},
            {"apart", a->separate}};
}

// Returns the numbers of operations of all events, according to the instruction budget of the modelled PEs.
Json budget_json(const EventCounts& events) {
    const Operations sum = operations_of(events);
    return {{"multiply_accumulates", sum.multiply_accumulates},
            {"divisions", sum.divisions},
            {"roots", sum.roots},
            {"moves", sum.moves},
            {"branches", sum.branches}};
}

Json modelled_json(const ModelledTime& time) {
    return {{"objects", time.objects_ms},
            {"compute", time.compute_ms},
            {"filter", time.filter_ms},
            {"compare", time.compare_ms},
            {"communication", time.communication_ms},
            {"image", time.image_ms},
            {"display", time.display_ms},
            {"total", time.total_ms},
            {"factor", time.factor}};
}

std::string antialias_lines(const RingSettings& settings, const RingResult& result) {
    const Antialias& a = settings.antialias;
    if (a.method == AntialiasMethod::kNone) return {};
    std::string text;
    if (a.method == AntialiasMethod::kSupersample)
        text += fmt::format("super   {} pixels ({:.1f} %) recomputed from 4 more points each, threshold {}\n",
                            result.recomputed, 100 * recomputed_share(result), a.threshold);
    if (result.phases.size() > 1)
        for (const Phase& phase : result.phases) text += load_line("  " + phase.name.substr(0, 5), phase.load);
    const Communication& c = result.communication;
    if (a.exchange == ExchangeMethod::kBus)
        return text +
               fmt::format("bus     {} between PEs, {} words\n", counted(c.transfers, "transfer"), c.transfer_words);
    if (a.exchange == ExchangeMethod::kBroadcast)
        return text + fmt::format("bus     {} by PEs, {} words\n", counted(c.pe_broadcasts, "broadcast"),
                                  c.pe_broadcast_words);
    return text + fmt::format("ring    {}, {} words\n", counted(c.rotations, "rotation"), c.rotation_words);
}

std::string model_line(const ModelledTime& t, const std::string& machine) {
    return fmt::format(
        "model   objects {}, compute {}, communication {}, image {}, display {}: {} (modelled time of {})\n",
        time_text(t.objects_ms), time_text(t.compute_ms), time_text(t.communication_ms), time_text(t.image_ms),
        time_text(t.display_ms), time_text(t.total_ms), machine);
}

std::string accel_line(const RingResult& r, bool all_counted) {
    if (!r.accel) return {};
    const AccelSummary& a = *r.accel;
    const auto rays = static_cast<double>(ray_count(r.events));
    const std::string tests = all_counted ? fmt::format("; {:.1f} tests and {:.1f} {} a ray",
                                                        static_cast<double>(test_count(r.events)) / rays,
                                                        static_cast<double>(r.events[RAYA_STEPS]) / rays,
                                                        a.kind == AccelKind::kBvh ? "nodes" : "steps")
                                          : "";
    const std::string separate = a.separate ? fmt::format(", {} listed separately", a.separate) : "";
    if (a.kind == AccelKind::kBvh)
        return fmt::format("bvh     {}, {}, depth {}{}{}\n", counted(a.nodes, "node"),
                           counted(a.leaves, "leaf", "leaves"), a.depth, separate, tests);
    return fmt::format("grid    {}x{}x{} voxels, {} of objects{}{}\n", a.divisions[0], a.divisions[1], a.divisions[2],
                       counted(a.copies, "copy", "copies"), separate, tests);
}

}  // namespace

ModelledTime ring_time(const RingSettings& settings, const RingResult& result) {
    std::vector<Load> loads;
    for (const Phase& phase : result.phases) loads.push_back(phase.load);
    return modelled_time(settings.machine.clock, loads, result.communication,
                         smoothing_cycles(settings.antialias.method, largest_share(settings.mapping)));
}

MachineReport ring_report(const RingSettings& settings, const RingResult& result) {
    const ModelledTime time = ring_time(settings, result);
    const bool all_counted = !settings.packets;
    return {.json = {{"accel", accel_json(result.accel)},
                     {"antialias", antialias_json(settings, result)},
                     {"communication", communication_json(result.communication)},
                     {"budget", budget_json(result.events)},
                     {"modelled_ms", modelled_json(time)}},
            .lines = antialias_lines(settings, result) + (all_counted ? model_line(time, settings.machine.name) : "") +
                     accel_line(result, all_counted)};
}

}  // namespace raya
