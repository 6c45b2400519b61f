#include "host/report/render_report.hpp"

#include "host/base/encoding.hpp"
#include "host/base/json.hpp"
#include "host/report/scene_report.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

Json image_json(const RenderReport& r) {
    Json json = {{"width", r.image.width},
                 {"height", r.image.height},
                 {"file", r.image.file},
                 {"hash", r.image.hash},
                 {"exposure", r.image.exposure}};
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

}  // namespace

std::uint64_t ray_count(const EventCounts& e) {
    return e[RAYA_PRIMARY] + e[RAYA_REFLECTED] + e[RAYA_REFRACTED] + e[RAYA_SHADOW];
}

std::uint64_t test_count(const EventCounts& e) {
    return e[RAYA_SPHERE_TESTS] + e[RAYA_PLANE_TESTS] + e[RAYA_POLYGON_TESTS] + e[RAYA_CONE_TESTS];
}

Json to_json(const RenderReport& r) {
    Json json = Json::object();
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
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
        const std::string member = kEvents[event].member;
        const std::size_t dot = member.find('.');
        if (dot != std::string::npos)
            (*json.emplace(member.substr(0, dot), Json::object()).first)[member.substr(dot + 1)] = r.events[event];
        else if (!member.empty())
            json[member] = r.events[event];
    }
    json["load"] = loads_json(r);
    json.update(r.of_machine.json);
    json["measured"] = measured_json(r);
    return json;
}

}  // namespace raya
