#include "host/report/render_report.hpp"

#include "host/base/encoding.hpp"
#include "host/base/json.hpp"
#include "host/model/budget.hpp"
#include "host/report/profile_table.hpp"
#include "host/report/scene_report.hpp"

namespace raya {
namespace {

Json codes_json(const std::optional<CodeConversion>& codes) {
    if (!codes) return {};
    return {{"exposure", codes->exposure}, {"tone", codes->tone}, {"gamma", codes->gamma}};
}

Json image_json(const RenderReport& r) {
    Json json = {{"width", r.image.width},
                 {"height", r.image.height},
                 {"file", r.image.file},
                 {"hash", r.image.hash},
                 {"codes", codes_json(r.image.codes)}};
    const auto& preview = r.image.preview;
    if (!preview.png.empty())
        json["preview"] = {{"width", preview.width}, {"height", preview.height}, {"png", base64(preview.png)}};
    return json;
}

Json load_json(const Load& load) {
    return {{"unit", "cycles"},
            {"mean", load.mean},
            {"max", load.max},
            {"min", load.min},
            {"imbalance", load.imbalance},
            {"speedup", load.speedup},
            {"efficiency", load.efficiency},
            {"per_pe", load.per_pe}};
}

Json loads_json(const RenderReport& r) {
    Json all = load_json(r.load);
    all["simulated"] = r.requests.has_value();
    if (r.requests) all["requests"] = *r.requests;
    for (const auto& [phase, load] : r.loads) all[phase] = load_json(load);
    return all;
}

Json antialias_json(const std::optional<Antialiasing>& a) {
    if (!a) return {{"method", "none"}};
    Json json = {{"method", a->method}, {"exchange", a->exchange}, {"band_pixels", a->band_pixels}};
    if (a->points.empty()) return json;
    json["threshold"] = a->threshold;
    json["points"] = a->points;
    json["recomputed_pixels"] = a->recomputed;
    json["recomputed_share"] = a->recomputed_share;
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

Json measured_json(const RenderReport& report) {
    const auto& m = report.measured;
    Json json = {{"build_s", m.build_s}, {"render_s", m.render_s}};
    if (report.accel_s > 0) json["accel_s"] = report.accel_s;
    if (m.earlier_s > 0) json["earlier_s"] = m.earlier_s;
    json["commands"] = commands_json(m.commands, m.roofline.has_value());
    if (!report.ranks.empty()) json["ranks"] = report.ranks;
    if (!m.roofline) return json;
    json["builds"] = builds_json(m.builds);
    add_to(json, *m.roofline);
    return json;
}

Json machine_json(const RenderReport& r) {
    return {{"name", r.machine.name},
            {"topology", r.machine.topology},
            {"pes", r.machine.pes},
            {"mapping", r.machine.mapping},
            {"offset", r.machine.offset ? Json(*r.machine.offset) : Json()},
            {"fold", r.machine.fold ? Json(*r.machine.fold) : Json()},
            {"format", r.machine.format},
            {"length_exponent", r.machine.length_exponent},
            {"bounces", r.machine.bounces},
            {"pe_memory_bytes", r.machine.pe_memory_bytes ? Json(r.machine.pe_memory_bytes) : Json()},
            {"pe_memory_used_bytes", r.machine.pe_memory_used_bytes}};
}

void add_ring(Json& json, const RenderReport& r) {
    json["accel"] = accel_json(r.accel);
    json["antialias"] = antialias_json(r.antialias);
    json["communication"] = communication_json(r.communication);
    json["budget"] = budget_json(r.events);
    json["modelled_ms"] = modelled_json(r.modelled);
}

void add_torus(Json& json, const RenderReport& r) {
    json["torus"] = torus_json(*r.torus);
    json["budget"] = t805_budget_json(r.events, r.torus->packets);
    json["modelled_ms"] = torus_time_json(r.torus->modelled);
}

}  // namespace

std::uint64_t ray_count(const EventCounts& e) {
    return e[RAYA_PRIMARY] + e[RAYA_REFLECTED] + e[RAYA_REFRACTED] + e[RAYA_SHADOW];
}

std::uint64_t test_count(const EventCounts& e) {
    return e[RAYA_SPHERE_TESTS] + e[RAYA_PLANE_TESTS] + e[RAYA_POLYGON_TESTS] + e[RAYA_CONE_TESTS];
}

Json to_json(const RenderReport& r) {
    const EventCounts& e = r.events;
    Json json;
    json["kind"] = kRenderReportKind;
    json["raya"] = r.raya;
    json["scene"] = r.scene;
    json["warnings"] = r.warnings;
    json["skipped"] = skipped_json(r.skipped);
    json["view"] = r.view;
    json["image"] = image_json(r);
    json["machine"] = machine_json(r);
    json["device"] = {{"name", r.device.name},       {"platform", r.device.platform},
                      {"version", r.device.version}, {"driver", r.device.driver},
                      {"lanes", r.device.lanes},     {"group_size", r.device.group_size},
                      {"tuned", r.device.tuned},     {"build_options", r.device.build_options}};
    json["rays"] = {{"primary", e[RAYA_PRIMARY]},     {"primary_hits", e[RAYA_PRIMARY_HITS]},
                    {"reflected", e[RAYA_REFLECTED]}, {"refracted", e[RAYA_REFRACTED]},
                    {"shadow", e[RAYA_SHADOW]},       {"shadow_hits", e[RAYA_SHADOW_HITS]}};
    json["tests"] = {{"sphere", e[RAYA_SPHERE_TESTS]},
                     {"plane", e[RAYA_PLANE_TESTS]},
                     {"polygon", e[RAYA_POLYGON_TESTS]},
                     {"cone", e[RAYA_CONE_TESTS]}};
    json["walks"] = e[RAYA_WALKS];
    json["steps"] = e[RAYA_STEPS];
    json["shading"] = {{"hits", e[RAYA_SHADED]}, {"lit", e[RAYA_LIT]}, {"highlights", e[RAYA_HIGHLIGHTS]}};
    json["load"] = loads_json(r);
    if (r.torus)
        add_torus(json, r);
    else
        add_ring(json, r);
    json["measured"] = measured_json(r);
    return json;
}

}  // namespace raya
