#include "host/report/render_report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/base/encoding.hpp"
#include "host/model/budget.hpp"
#include "host/model/number_format.hpp"
#include "host/report/scene_report.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

double as_double(std::uint64_t count) { return static_cast<double>(count); }

double per_second(double count, double seconds) { return seconds > 0 ? count / seconds : 0; }

// Returns the time of the operations, in seconds, at the peak rates of multiply-adds, divisions and square roots in the
// number format.
double seconds_in_format(const KernelWork& w, const DevicePeak& peak) {
    return as_double(w.operations) / peak.multiply_per_s + as_double(w.divisions) / peak.divide_per_s +
           as_double(w.roots) / peak.sqrt_per_s;
}

RooflineRow row_of(const KernelWork& work, const LabelSummary& launches, const DevicePeak& peak) {
    const double seconds = 1e-9 * as_double(launches.total_ns);
    RooflineRow row{.work = work, .seconds = seconds};
    const double operations = as_double(work.all_operations()), bytes = as_double(work.bytes);
    row.intensity = bytes > 0 ? operations / bytes : 0;
    const double compute_s = operations / peak.fp32_per_s, copy_s = bytes / peak.copy_bytes_per_s;
    row.bound = compute_s >= copy_s ? Bound::kCompute : Bound::kBandwidth;
    row.roof_fraction = std::max(compute_s, copy_s) / seconds;
    if (operations > 0) row.format_fraction = seconds_in_format(work, peak) / seconds;
    return row;
}

bool is_known(const DevicePeak& p) {
    return p.fp32_per_s > 0 && p.multiply_per_s > 0 && p.divide_per_s > 0 && p.sqrt_per_s > 0 && p.copy_bytes_per_s > 0;
}

const char* bound_name(Bound bound) { return bound == Bound::kCompute ? "compute" : "bandwidth"; }

std::string percent_text(double fraction) { return fmt::format("{:.2f}", 100 * fraction); }

// Returns `text`, or "-" if the value is 0.
std::string cell(double value, const std::string& text) { return value > 0 ? text : "-"; }

std::vector<std::string> cells_of(const RooflineRow& r) {
    const double operations = as_double(r.work.all_operations()), rays = as_double(r.work.rays),
                 bytes = as_double(r.work.bytes);
    return {r.work.label,
            cell(rays, fmt::format("{:.2f}", 1e-6 * per_second(rays, r.seconds))),
            cell(operations, fmt::format("{:.4f}", 1e-9 * operations)),
            cell(operations, fmt::format("{:.3f}", 1e-9 * per_second(operations, r.seconds))),
            cell(bytes, fmt::format("{:.3f}", 1e-6 * bytes)),
            cell(bytes, fmt::format("{:.3f}", 1e-9 * per_second(bytes, r.seconds))),
            cell(r.intensity, fmt::format("{:.3g}", r.intensity)),
            bound_name(r.bound),
            percent_text(r.roof_fraction),
            r.format_fraction ? percent_text(*r.format_fraction) : "-"};
}

std::string peak_line(const DevicePeak& p) {
    return fmt::format(
        "peak    {:.2f} Gop/s multiply-adds in fp32; in {}: {:.2f} multiply-adds, {:.2f} divisions, {:.2f} square "
        "roots; "
        "{:.2f} GB/s copied{}\n",
        1e-9 * p.fp32_per_s, p.format, 1e-9 * p.multiply_per_s, 1e-9 * p.divide_per_s, 1e-9 * p.sqrt_per_s,
        1e-9 * p.copy_bytes_per_s,
        p.scatter > kMaxScatter ? fmt::format("; unreliable, measurements differ by {:.0f} %", 100 * p.scatter) : "");
}

std::string legend_lines(const DevicePeak& p) {
    return fmt::format(
        "        measured in this run by small programs; copies of {} MB, each byte counted as read and as written\n"
        "        (the table of commands counts it once)\n"
        "op      an addition, multiplication, comparison, multiply-add, division or square root in the budgets of "
        "the counted events\n"
        "MB      the minimum that the kernel has to read and write. The roof is compute above {:.2f} op/byte, "
        "otherwise bandwidth\n",
        p.copy_bytes >> 20, p.fp32_per_s / p.copy_bytes_per_s);
}

std::string format_remark(const DevicePeak& p) {
    const std::string text =
        "format  the time of the same operations at the rates of " + p.format + ", in % of the kernel's time";
    if (p.format == "fp32") return text + "\n";
    return text +
           "; each operation takes many instructions;\n"
           "        it is above 100 % if most operations are cheaper: comparisons, and spheres that the fp32 filter "
           "rejects\n";
}

// Returns a line with the kernel's bound and the percentage of the roof that it achieves.
std::string verdict(const RooflineRow& r, const DevicePeak& p) {
    const bool compute = r.bound == Bound::kCompute;
    std::string line =
        fmt::format("roof    {}: {} bound, {:.2f} % of {}", r.work.label, bound_name(r.bound), 100 * r.roof_fraction,
                    compute ? "the fp32 multiply-add rate" : "the copy bandwidth");
    if (r.format_fraction) line += fmt::format(", {:.2f} % of the rates of {}", 100 * *r.format_fraction, p.format);
    return line + "\n";
}

}  // namespace

KernelWork work_of(const std::string& label, const EventCounts& events) {
    const Operations sum = operations_of(events);
    return {.label = label,
            .rays = events[RAYA_PRIMARY] + events[RAYA_REFLECTED] + events[RAYA_REFRACTED] + events[RAYA_SHADOW],
            .operations = sum.multiply_accumulates,
            .divisions = sum.divisions,
            .roots = sum.roots};
}

Roofline roofline(const DevicePeak& peak, const std::vector<KernelWork>& works,
                  const std::vector<LabelSummary>& commands) {
    Roofline all{.peak = peak};
    if (!is_known(peak)) all.unavailable = "the device does not time its commands";
    if (!is_known(peak)) return all;
    for (const KernelWork& work : works)
        for (const LabelSummary& c : commands)
            if (c.label == work.label && c.kind == "kernel" && c.total_ns > 0)
                all.rows.push_back(row_of(work, c, peak));
    return all;
}

std::string roofline_table(const Roofline& roofline, bool legend) {
    if (!roofline.unavailable.empty()) return "no roofline: " + roofline.unavailable + "\n";
    std::vector<std::vector<std::string>> rows = {
        {"kernel", "Mrays/s", "Gop", "Gop/s", "MB", "GB/s", "op/byte", "bound", "% of roof", "% of format"}};
    for (const RooflineRow& row : roofline.rows) rows.push_back(cells_of(row));
    std::string text = text_table(rows) + peak_line(roofline.peak);
    if (legend) text += legend_lines(roofline.peak) + format_remark(roofline.peak);
    for (const RooflineRow& row : roofline.rows) text += verdict(row, roofline.peak);
    return text;
}

Json peak_json(const DevicePeak& p) {
    return {{"fp32_multiply_adds_per_s", p.fp32_per_s},
            {"format", p.format},
            {"format_multiply_adds_per_s", p.multiply_per_s},
            {"format_divisions_per_s", p.divide_per_s},
            {"format_roots_per_s", p.sqrt_per_s},
            {"copy_bytes_per_s", p.copy_bytes_per_s},
            {"copy_buffer_bytes", p.copy_bytes},
            {"scatter", p.scatter}};
}

Json roofline_json(const Roofline& roofline) {
    Json rows = Json::array();
    for (const RooflineRow& r : roofline.rows) {
        const double operations = as_double(r.work.all_operations());
        rows.push_back({{"label", r.work.label},
                        {"rays", r.work.rays},
                        {"rays_per_s", per_second(as_double(r.work.rays), r.seconds)},
                        {"operations", r.work.all_operations()},
                        {"operations_per_s", per_second(operations, r.seconds)},
                        {"bytes", r.work.bytes},
                        {"bytes_per_s", per_second(as_double(r.work.bytes), r.seconds)},
                        {"operations_per_byte", r.intensity},
                        {"bound", bound_name(r.bound)},
                        {"share_of_roof", r.roof_fraction},
                        {"share_of_format", r.format_fraction ? Json(*r.format_fraction) : Json()}});
    }
    return rows;
}

void add_to(Json& json, const Roofline& roofline) {
    if (!roofline.unavailable.empty()) {
        json["no_roofline"] = roofline.unavailable;
        return;
    }
    json["peak"] = peak_json(roofline.peak);
    json["roofline"] = roofline_json(roofline);
}

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
#define RAYA_TESTS(kind, kinds, KIND) +e[RAYA_##KIND##_TESTS]
    return 0 RAYA_OBJECT_LIST(RAYA_TESTS);
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

namespace {

std::string machine_text(const RenderReport& r) {
    if (!r.of_machine.title.empty()) return r.of_machine.title;
    return fmt::format("{}, {} mapping{}", counted(r.machine.pes, "PE"), r.machine.mapping,
                       r.machine.offset ? fmt::format(", offset {}", *r.machine.offset) : "");
}

std::string scale_line(const RenderReport& r) {
    if (r.machine.length_exponent == 0) return {};
    return fmt::format("scale   lengths x 2^{}, to fit the range of {}\n", r.machine.length_exponent, r.machine.format);
}

std::string memory_line(const RenderReport& r) {
    return fmt::format("memory  {} in {}{}{}\n", required_size_text(r.machine.pe_memory_used_bytes),
                       r.of_machine.title.empty() ? "each PE" : "the fullest node",
                       r.machine.pe_memory_bytes ? fmt::format(" of {}", available_size_text(r.machine.pe_memory_bytes))
                                                 : ", no limit",
                       r.of_machine.memory);
}

// Returns a line with the number and size of the messages of all ranks, and the longest waiting time of a rank.
std::string ranks_line(const RenderReport& r) {
    if (r.ranks.empty()) return {};
    double max_waiting_s = 0;
    std::uint64_t messages = 0, bytes = 0;
    std::set<std::string> hosts;
    for (const Json& rank : r.ranks) {
        max_waiting_s = std::max(max_waiting_s, json_number(rank.at("waiting_s")));
        messages += json_integer(rank.at("messages_sent"));
        bytes += json_integer(rank.at("bytes_sent"));
        hosts.insert(json_text(rank.at("host")));
    }
    return fmt::format("ranks   {} on {}; {}, {} sent; longest wait for other ranks {:.3f} s\n", r.ranks.size(),
                       counted(hosts.size(), "host"), counted(messages, "message"), required_size_text(bytes),
                       max_waiting_s);
}

}  // namespace

std::string load_line(const std::string& label, const Load& load, const std::string& remark) {
    return fmt::format("{:7} u = {:.3f}, speed-up {:.1f} of {}, efficiency {:.1f} % (modelled cycles{})\n", label,
                       load.imbalance, load.speedup, load.per_pe.size(), 100 * load.efficiency, remark);
}

std::string summary_text(const RenderReport& r) {
    const EventCounts& e = r.events;
    const std::uint64_t rays = ray_count(e);
    std::string text =
        fmt::format("{}: {} x {} pixels on {} ({}), {}, {}\n", r.scene, r.image.width, r.image.height, r.machine.name,
                    machine_text(r), r.machine.format, counted(r.machine.bounces, "bounce"));
    text += fmt::format("rays    {} = {} primary + {} reflected + {} refracted + {} shadow\n", rays, e[RAYA_PRIMARY],
                        e[RAYA_REFLECTED], e[RAYA_REFRACTED], e[RAYA_SHADOW]);
    if (r.counted) text += load_line("load", r.load, r.requests ? ", simulated" : "");
    text += r.of_machine.lines + scale_line(r) + memory_line(r);
    text += fmt::format("time    kernel build {:.2f} s, render {:.3f} s, {} on {} ({})\n", r.measured.build_s,
                        r.measured.render_s, rate_text(static_cast<double>(rays) / r.measured.render_s), r.device.name,
                        counted(r.device.lanes, "lane"));
    const bool tuned_by_file = r.device.tuned != "defaults" && r.device.tuned != "options";
    if (tuned_by_file && !r.device.tuned.empty()) text += fmt::format("tuned   {}\n", r.device.tuned);
    text += ranks_line(r);
    text += fmt::format("image   {} ({})\n", r.image.file, r.image.hash);
    return text;
}

}  // namespace raya
