#include "host/report/scene_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "host/model/number_format.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

std::uint64_t count_patches(const Scene& scene) {
    return std::ranges::count_if(scene.polygons, [](const Polygon& p) { return !p.normals.empty(); });
}

std::uint64_t count_vertices(const Scene& scene) {
    std::uint64_t vertices = 0;
    for (const Polygon& p : scene.polygons) vertices += p.vertices.size();
    return vertices;
}

std::uint64_t count_checkers(const Scene& scene) {
    return std::ranges::count_if(scene.surfaces, [](const Surface& s) { return s.checker.has_value(); });
}

Json objects_json(const Scene& s) {
#define RAYA_KIND_MEMBER(kind, kinds, KIND) {#kinds, s.kinds.size()},
    return {{"all", s.object_count()},
            RAYA_OBJECT_LIST(RAYA_KIND_MEMBER){"patches", count_patches(s)},
            {"vertices", count_vertices(s)}};
}

Json vector_json(const Vec3& v) { return std::array{v.x, v.y, v.z}; }

Json extent_json(const SceneReport& r) {
    Json box = Json::object();
    if (!r.box.isEmpty()) box = {{"min", vector_json(r.box.min)}, {"max", vector_json(r.box.max)}};
    return {{"box", box}, {"cube_half_side", scene_extent(r.scene)}};
}

Json format_json(const FormatFit& f) {
    return {{"format", f.format},
            {"fits", f.refusal.empty()},
            {"length_exponent", f.scale.exponent},
            {"largest", f.scale.largest_length},
            {"smallest", f.scale.smallest_length},
            {"least_seen", f.scale.min_visible},
            {"vanishing", f.scale.vanishing_count},
            {"refusal", f.refusal.empty() ? Json() : Json(f.refusal)}};
}

Json need_json(const AccelNeed& n) {
    return {{"accel", n.accel},
            {"default", n.is_default},
            {"fits", n.refusal.empty()},
            {"job_words", n.words},
            {"job_bytes", 4 * n.words},
            {"accel_words", n.summary.words},
            {"pe_memory_used_bytes", n.pe_bytes},
            {"missing_bytes", n.missing_bytes},
            {"refusal", n.refusal.empty() ? Json() : Json(n.refusal)}};
}

Json machine_json(const MachineNeeds& m) {
    Json needs = Json::array();
    for (const AccelNeed& need : m.needs) needs.push_back(need_json(need));
    return {{"name", m.machine},  {"pes", m.pes},
            {"format", m.format}, {"pe_memory_bytes", m.memory_bytes},
            {"needs", needs},     {"refusal", m.refusal.empty() ? Json() : Json(m.refusal)}};
}

template <class T>
Json list_json(const std::vector<T>& list, Json (*element_json)(const T&)) {
    Json json = Json::array();
    for (const T& element : list) json.push_back(element_json(element));
    return json;
}

std::string objects_text(const Scene& s) {
    std::vector<std::string> kinds;
    const auto add = [&](std::uint64_t count, const std::string& singular, const std::string& plural) {
        if (count > 0) kinds.push_back(counted(count, singular, plural));
    };
    const std::uint64_t patches = count_patches(s);
#define RAYA_ADD_KIND(kind, kinds, KIND) \
    add(s.kinds.size() - (RAYA_##KIND == RAYA_POLYGON ? patches : 0), #kind, #kinds);
    RAYA_OBJECT_LIST(RAYA_ADD_KIND)
    add(patches, "patch", "patches");
    std::string text = fmt::format("{}: {}", counted(s.object_count(), "object"), fmt::join(kinds, ", "));
    if (!s.polygons.empty()) text += fmt::format(" ({} vertices)", count_vertices(s));
    text += "; " + counted(s.surfaces.size(), "surface");
    if (count_checkers(s) > 0) text += fmt::format(", {} with a checker", count_checkers(s));
    return text;
}

std::string vector_text(const Vec3& v) { return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z); }

std::string lights_text(const Scene& scene) {
    constexpr std::size_t kShown = 4;
    std::vector<std::string> lights;
    for (const Light& light : scene.lights) {
        if (lights.size() == kShown) break;
        lights.push_back(
            fmt::format("at {} of {}", vector_text(light.position), vector_text(light_colour(scene, light))));
    }
    std::string text = lights.empty() ? "none; only ambient light"
                                      : fmt::format("{}: {}", scene.lights.size(), fmt::join(lights, "; "));
    if (scene.lights.size() > kShown) text += fmt::format("; and {} more", scene.lights.size() - kShown);
    return text;
}

std::string extent_text(const SceneReport& r) {
    std::string box = "no bounding box, only planes";
    if (!r.box.isEmpty())
        box = fmt::format("{:.6g}..{:.6g} x {:.6g}..{:.6g} x {:.6g}..{:.6g}", r.box.min.x, r.box.max.x, r.box.min.y,
                          r.box.max.y, r.box.min.z, r.box.max.z);
    return fmt::format("{}; objects and camera at most {:.6g} from the origin along each axis", box,
                       scene_extent(r.scene));
}

std::string format_text(const FormatFit& f) {
    if (!f.refusal.empty()) return f.refusal;
    std::string text = f.format + ": ";
    text += f.scale.exponent == 0 ? "lengths unchanged" : fmt::format("lengths x 2^{}", f.scale.exponent);
    if (f.scale.vanishing_count > 0)
        text += fmt::format(", {} spheres, cones or checkers smaller than {:.3g} are not visible",
                            f.scale.vanishing_count, f.scale.min_visible);
    return text;
}

// Returns "fits", "needs 12 KB more" or "refused".
std::string verdict(const AccelNeed& need) {
    if (need.refusal.empty()) return "fits";
    if (need.missing_bytes > 0) return fmt::format("needs {} more", required_size_text(need.missing_bytes));
    return "refused";
}

std::string machine_table(const std::vector<MachineNeeds>& machines) {
    std::vector<std::vector<std::string>> rows = {
        {"machine", "PEs", "format", "accel", "job words", "needed per PE", "available", "verdict"}};
    for (const MachineNeeds& m : machines)
        for (const AccelNeed& n : m.needs)
            rows.push_back({m.machine, std::to_string(m.pes), m.format, n.accel + (n.is_default ? " *" : ""),
                            n.words > 0 ? std::to_string(n.words) : "-",
                            n.pe_bytes > 0 ? required_size_text(n.pe_bytes) : "-",
                            m.memory_bytes ? available_size_text(*m.memory_bytes) : "no limit", verdict(n)});
    return rows.size() == 1 ? "" : text_table(rows) + "*: the machine's default\n";
}

// Returns the error messages for reasons other than memory.
std::string refusals_text(const std::vector<MachineNeeds>& machines) {
    std::string text;
    for (const MachineNeeds& m : machines) {
        if (!m.refusal.empty()) text += fmt::format("{}: {}\n", m.machine, m.refusal);
        for (const AccelNeed& n : m.needs)
            if (!n.refusal.empty() && n.missing_bytes == 0)
                text += fmt::format("{}, {}: {}\n", m.machine, n.accel, n.refusal);
    }
    return text;
}

}  // namespace

Json to_json(const SceneReport& r) {
    const Scene& s = r.scene;
    Json json = Json::object();
    json["kind"] = "raya info";
    json["raya"] = r.raya;
    json["scene"] = r.file;
    json["warnings"] = r.warnings;
    json["skipped"] = skipped_json(r.skipped);
    json["objects"] = objects_json(s);
    json["surfaces"] = s.surfaces.size();
    json["checkers"] = count_checkers(s);
    json["view"] = view_json(s);
    json["resolution"] = {{"width", s.view.width}, {"height", s.view.height}};
    json["extent"] = extent_json(r);
    json["formats"] = list_json(r.formats, format_json);
    json["machines"] = list_json(r.machines, machine_json);
    return json;
}

std::string summary_text(const SceneReport& r) {
    const View& v = r.scene.view;
    std::string text = fmt::format("{}: {}\n", r.file, objects_text(r.scene));
    text += fmt::format("camera  from {} at {} up {}, {:.6g} degrees, {} x {} pixels, background {}\n",
                        vector_text(v.from), vector_text(v.at), vector_text(v.up), v.angle_degrees, v.width, v.height,
                        vector_text(r.scene.background));
    text += fmt::format("lights  {}\n", lights_text(r.scene));
    text += fmt::format("extent  {}\n", extent_text(r));
    for (const SceneRemark& remark : r.skipped) text += fmt::format("skipped {}\n", remark_text(r.file, remark));
    for (const FormatFit& f : r.formats) text += fmt::format("format  {}\n", format_text(f));
    return text + "\n" + machine_table(r.machines) + refusals_text(r.machines);
}

Json skipped_json(const std::vector<SceneRemark>& skipped) {
    Json list = Json::array();
    for (const SceneRemark& remark : skipped) {
        Json json = {{"what", remark.what}, {"count", remark.count}};
        if (remark.line > 0)
            json["line"] = remark.line;
        else
            json["place"] = remark.place;
        list.push_back(json);
    }
    return list;
}

Json view_json(const Scene& scene) {
    Json lights = Json::array();
    for (const Light& light : scene.lights)
        lights.push_back(
            {{"position", vector_json(light.position)}, {"colour", vector_json(light_colour(scene, light))}});
    return {{"from", vector_json(scene.view.from)},
            {"at", vector_json(scene.view.at)},
            {"up", vector_json(scene.view.up)},
            {"angle_degrees", scene.view.angle_degrees},
            {"background", vector_json(scene.background)},
            {"lights", lights}};
}

}  // namespace raya
