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

void object_members(Members& m, const Scene& s) {
    m("all", s.object_count(), "Number of spheres, planes, polygons and cones.");
#define RAYA_KIND_MEMBER(kind, kinds, KIND) \
    m(#kinds, s.kinds.size(), "Number of " #kinds "; polygons include patches, cones include cylinders.");
    RAYA_OBJECT_LIST(RAYA_KIND_MEMBER)
    m("patches", count_patches(s), "Number of patches: polygons with a normal at each vertex.");
    m("vertices", count_vertices(s), "Number of vertices of all polygons.");
}

std::array<double, 3> array_of(const Vec3& v) { return {v.x, v.y, v.z}; }

void extent_members(Members& m, const SceneReport& r) {
    m("box", "Bounding box of the finite objects; without members if the scene has no finite objects.",
      [&](Members& box) {
          box.when(!r.box.is_empty(), "min", array_of(r.box.min), "Lower corner, scene units.");
          box.when(!r.box.is_empty(), "max", array_of(r.box.max), "Upper corner, scene units.");
      });
    m("cube_half_side", scene_extent(r.scene),
      "Maximum absolute coordinate of finite objects and camera, scene units.");
}

std::optional<std::string> text_or_null(const std::string& text) {
    return text.empty() ? std::nullopt : std::optional(text);
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
    for (std::size_t i = 0; i < std::min(kShown, scene.lights.size()); ++i) {
        const Light& light = scene.lights[i];
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
    if (!r.box.is_empty())
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

// Returns "fits", "fits in 4 parts", "needs 12 KB more" or "refused".
std::string verdict(const AccelNeed& need) {
    if (need.refusal.empty()) return need.parts > 1 ? fmt::format("fits in {} parts", need.parts) : "fits";
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

static void members_of(Members& m, const FormatFit& f) {
    m("format", f.format, kFormatMeaning);
    m("fits", f.refusal.empty(), "True if the scene can be rendered in this format.");
    m("length_exponent", f.scale.exponent, "Exponent e: raya multiplies all lengths by 2^e.");
    m("largest", f.scale.largest_length, "Largest coordinate, or distance of a plane, scene units.");
    m("smallest", f.scale.smallest_length, "Smallest radius, height or side of a square, scene units.");
    m("least_seen", f.scale.min_visible, "Smallest visible length, scene units.");
    m("vanishing", f.scale.vanishing_count, "Number of spheres, cones and checkers smaller than `least_seen`.");
    m("refusal", text_or_null(f.refusal), "Error message of a render; null: accepted.");
}

static void members_of(Members& m, const AccelNeed& n) {
    m("accel", n.accel, "Acceleration structure, as given to --accel; `voxels` on the torus.");
    m("default", n.is_default, "True if this acceleration structure is the machine's default for the scene.");
    m("fits", n.refusal.empty(), "True if the scene can be rendered with this acceleration structure.");
    m("job_words", n.words, "32-bit words of scene and accelerator in each PE, or in the fullest node.");
    m.when(n.parts > 1, "parts", n.parts,
           "Parts of the objects, which rotate on the ring; `job_words` has all of them.");
    m("job_bytes", 4 * n.words, "Size of these words in bytes: 4 times `job_words`.");
    m("accel_words", n.summary.words, "Part of `job_words` that belongs to the acceleration structure.");
    m("pe_memory_used_bytes", n.pe_bytes,
      "Memory that the render needs in a PE, bytes; 0: refused for another reason.");
    m("missing_bytes", n.missing_bytes, "Bytes by which a PE's memory is too small; 0: it fits.");
    m("refusal", text_or_null(n.refusal), "Error message of a render; null: accepted.");
}

static void members_of(Members& m, const MachineNeeds& machine) {
    m("name", machine.machine, "Name, as given to --machine.");
    m("pes", machine.pes, "Number of PEs or nodes; 0: the machine refuses the options.");
    m("format", machine.format, "Number format; empty if the machine refuses the options (`refusal`).");
    m("pe_memory_bytes", machine.memory_bytes, "Memory of a PE in bytes; null if unlimited.");
    m("needs", machine.needs, "Memory of a PE with each acceleration structure; empty: refused.");
    m("refusal", text_or_null(machine.refusal), "Error message of a render; null: accepted.");
}

void members_of(Members& m, const SceneReport& r) {
    m("kind", "raya info", "Identifies the report: `raya info`.");
    m("raya", r.raya, kVersionMeaning);
    m("scene", r.file, kSceneMeaning);
    m("warnings", r.warnings, kWarningsMeaning);
    m("skipped", r.skipped, kSkippedMeaning);
    m("objects", "Numbers of objects of the scene.", [&](Members& o) { object_members(o, r.scene); });
    m("surfaces", r.scene.surfaces.size(), "Number of surfaces that objects use.");
    m("checkers", count_checkers(r.scene), "Number of surfaces with a checker.");
    m("view", view_of(r.scene), kViewMeaning);
    m("resolution", "Resolution in the scene file.", [&](Members& resolution) {
        resolution("width", r.scene.view.width, "Width in pixels.");
        resolution("height", r.scene.view.height, "Height in pixels.");
    });
    m("extent", "Size of the scene.", [&](Members& extent) { extent_members(extent, r); });
    m("formats", r.formats, "Number formats of the machines.");
    m("machines", r.machines, "All machines, or only the machine given with --machine.");
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

void members_of(Members& m, const SceneRemark& remark) {
    m("what", remark.what, "Kind of statement, and what raya did with it.");
    m("count", remark.count, "Number of statements of this kind.");
    m.when(remark.line > 0, "line", remark.line, "NFF: number of the line with the first of these statements.");
    m.when(remark.line == 0, "place", remark.place, "Mesh: mesh and face, or material; empty: the whole file.");
}

SceneView view_of(const Scene& scene) {
    SceneView view{scene.view, scene.background, scene.lights};
    for (Light& light : view.lights) light.colour = light_colour(scene, light);
    return view;
}

static void members_of(Members& m, const Light& light) {
    m("position", array_of(light.position), "Position, scene units.");
    m("colour", array_of(light.colour.value_or(Colour())), "Linear colour of the emitted light: red, green, blue.");
}

void members_of(Members& m, const SceneView& view) {
    m("from", array_of(view.camera.from), "Position of the camera, scene units.");
    m("at", array_of(view.camera.at), "Point at the centre of the image, scene units.");
    m("up", array_of(view.camera.up), "Up direction, of any length.");
    m("angle_degrees", view.camera.angle_degrees, "Vertical field of view, degrees.");
    m("background", array_of(view.background), "Linear colour of rays that hit nothing; 1 is full intensity.");
    m("lights", view.lights, "Point lights.");
}

}  // namespace raya
