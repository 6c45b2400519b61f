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

constexpr const char* kCommandsMeaning =
    "Commands of the device, one entry for each label and kind, in order of first use. The device's clock measures the "
    "times; they are 0 if the device does not time its commands (docs/profile.md).";

double as_double(std::uint64_t count) { return static_cast<double>(count); }

double per_second(double count, double seconds) { return seconds > 0 ? count / seconds : 0; }

RooflineRow row_of(const KernelWork& work, const LabelSummary& launches, const DevicePeak& peak) {
    const double seconds = 1e-9 * as_double(launches.total_ns);
    RooflineRow row{.work = work, .seconds = seconds};
    const double operations = as_double(work.all_operations()), bytes = as_double(work.bytes);
    row.intensity = bytes > 0 ? operations / bytes : 0;
    const double compute_s = operations / peak.fp32_per_s, copy_s = bytes / peak.copy_bytes_per_s;
    row.bound = compute_s >= copy_s ? "compute" : "bandwidth";
    row.roof_fraction = std::max(compute_s, copy_s) / seconds;
    if (operations > 0)
        row.format_fraction =
            (as_double(work.operations) / peak.multiply_per_s + as_double(work.divisions) / peak.divide_per_s +
             as_double(work.roots) / peak.sqrt_per_s) /
            seconds;
    return row;
}

bool is_known(const DevicePeak& p) {
    return p.fp32_per_s > 0 && p.multiply_per_s > 0 && p.divide_per_s > 0 && p.sqrt_per_s > 0 && p.copy_bytes_per_s > 0;
}

/// Returns the value as a table's cell; "-" if it is 0.
std::string cell(const char* format, double value) {
    return value > 0 ? fmt::format(fmt::runtime(format), value) : "-";
}

std::vector<std::string> cells_of(const RooflineRow& r) {
    const double operations = as_double(r.work.all_operations()), rays = as_double(r.work.rays),
                 bytes = as_double(r.work.bytes);
    return {r.work.label,
            cell("{:.2f}", 1e-6 * per_second(rays, r.seconds)),
            cell("{:.4f}", 1e-9 * operations),
            cell("{:.3f}", 1e-9 * per_second(operations, r.seconds)),
            cell("{:.3f}", 1e-6 * bytes),
            cell("{:.3f}", 1e-9 * per_second(bytes, r.seconds)),
            cell("{:.3g}", r.intensity),
            r.bound,
            fmt::format("{:.2f}", 100 * r.roof_fraction),
            cell("{:.2f}", 100 * r.format_fraction.value_or(0))};
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
    if (!is_known(peak)) return {.unavailable = "the device does not time its commands"};
    Roofline all{.peak = peak};
    for (const KernelWork& work : works)
        for (const LabelSummary& c : commands)
            if (c.label == work.label && c.kind == "kernel" && c.total_ns > 0)
                all.rows.push_back(row_of(work, c, peak));
    return all;
}

std::string roofline_table(const Roofline& roofline) {
    if (!roofline.unavailable.empty()) return "no roofline: " + roofline.unavailable + "\n";
    std::vector<std::vector<std::string>> rows = {
        {"kernel", "Mrays/s", "Gop", "Gop/s", "MB", "GB/s", "op/byte", "bound", "% of roof", "% of format"}};
    for (const RooflineRow& row : roofline.rows) rows.push_back(cells_of(row));
    const DevicePeak& p = roofline.peak;
    return text_table(rows) +
           fmt::format(
               "peak    {:.2f} Gop/s multiply-adds in fp32; in {}: {:.2f} multiply-adds, {:.2f} divisions, "
               "{:.2f} square roots; {:.2f} GB/s copied; docs/profile.md explains the columns\n",
               1e-9 * p.fp32_per_s, p.format, 1e-9 * p.multiply_per_s, 1e-9 * p.divide_per_s, 1e-9 * p.sqrt_per_s,
               1e-9 * p.copy_bytes_per_s);
}

static void members_of(Members& m, const DevicePeak& p) {
    m("fp32_multiply_adds_per_s", p.fp32_per_s, "fp32 multiply-adds per second; each is one operation.");
    m("format", p.format, kFormatMeaning);
    m("format_multiply_adds_per_s", p.multiply_per_s, "Multiply-adds per second in `format`.");
    m("format_divisions_per_s", p.divide_per_s, "Divisions per second in `format`.");
    m("format_roots_per_s", p.sqrt_per_s, "Square roots per second in `format`.");
    m("copy_bytes_per_s", p.copy_bytes_per_s, "Bytes read plus bytes written per second of a copy.");
    m("copy_buffer_bytes", p.copy_bytes, "Size of each of the two buffers, bytes.");
    m("scatter", p.scatter, "(best - worst) / best of three measurements of the fp32 rate.");
}

void members_of(Members& m, const RooflineRow& r) {
    const std::uint64_t operations = r.work.all_operations();
    const auto rate = [&](std::uint64_t count) { return per_second(as_double(count), r.seconds); };
    m("label", r.work.label, "Label of the kernel in `commands`.");
    m("rays", r.work.rays, "Number of rays that the kernel traced or generated.");
    m("rays_per_s", rate(r.work.rays), "Rays per second of device time.");
    m("operations", operations,
      "Operations of the budgets of all events (host/model/budget.hpp), the same on every device.");
    m("operations_per_s", rate(operations), "Operations per second of device time.");
    m("bytes", r.work.bytes, "Minimum number of bytes that the kernel has to read and write.");
    m("bytes_per_s", rate(r.work.bytes), "Bytes per second of device time.");
    m("operations_per_byte", r.intensity, "Arithmetic intensity: `operations` / `bytes`.");
    m("bound", r.bound, "The lower roof: `compute` (fp32 multiply-adds) or `bandwidth` (copies).");
    m("share_of_roof", r.roof_fraction, "Rate / roof at this arithmetic intensity; 1 at the limit of the device.");
    m("share_of_format", r.format_fraction,
      "Time at the peak rates of the format / time of the kernel; null without operations.");
}

void roofline_members(Members& m, const std::optional<Roofline>& roofline) {
    const Roofline shown = roofline.value_or(Roofline{});
    const bool available = roofline && shown.unavailable.empty();
    m.when(roofline && !available, "no_roofline", shown.unavailable, "Why there is no roofline.");
    m.when(available, "peak", shown.peak, "Highest rates of this device (docs/profile.md).");
    m.when(available, "roofline", shown.rows,
           "With --profile or --page: each kernel compared with the peak (Williams, Waterman & Patterson 2009).");
}

std::uint64_t ray_count(const EventCounts& e) {
    return e[RAYA_PRIMARY] + e[RAYA_REFLECTED] + e[RAYA_REFRACTED] + e[RAYA_SHADOW];
}

std::uint64_t test_count(const EventCounts& e) {
#define RAYA_TESTS(kind, kinds, KIND) +e[RAYA_##KIND##_TESTS]
    return 0 RAYA_OBJECT_LIST(RAYA_TESTS);
}

static void members_of(Members& m, const Load& load) {
    m("unit", "cycles", "`cycles` of a PE's processor.");
    m("mean", load.mean, "Mean over all PEs, cycles.");
    m("max", load.max, "Load of the busiest PE, cycles.");
    m("min", load.min, "Load of the least busy PE, cycles.");
    m("imbalance", load.imbalance, "u = (max - mean) / mean (Kohata & Ito 1993, Fig. 8); 0 if all loads are 0.");
    m("speedup", load.speedup, "Sum of the loads / max.");
    m("efficiency", load.efficiency, "Speed-up / number of PEs.");
    m("per_pe", load.per_pe, "Load of each PE, in the order of the PEs' numbers, cycles.");
}

void members_of(Members& m, const LabelSummary& c) {
    const auto mean_ns = [&](std::uint64_t total) { return as_double(total) / as_double(c.launches); };
    m("label", c.label, "Purpose of the command.");
    m("kind", c.kind, "Type of the command: `kernel`, `write`, `read`, `copy` or `fill`.");
    m("launches", c.launches, "Number of commands.");
    m("total_ns", c.total_ns, "Total time from start to end, ns.");
    m("min_ns", c.min_ns, "Shortest time from start to end, ns.");
    m("mean_ns", c.mean_ns, "Mean time from start to end, ns.");
    m("max_ns", c.max_ns, "Longest time from start to end, ns.");
    m("queue_to_submit_mean_ns", mean_ns(c.submit_ns), "Mean time from enqueueing to submission, ns.");
    m("submit_to_start_mean_ns", mean_ns(c.start_ns), "Mean time from submission to start, ns.");
    m("bytes", c.bytes, "Total number of bytes moved or filled; 0 for kernels.");
}

static void members_of(Members& m, const ProgramBuild& build) {
    m("program", build.name, "Kernel file.");
    m("seconds", build.seconds, "Build time of the program by the host's clock, s.");
}

void members_of(Members& m, const RankReport& r) {
    m("rank", r.rank, "Number of the rank.");
    m("host", r.host, "Host name.");
    m.when(!r.torus, "pes", r.parts, "Number of PEs of the ring that this rank models.");
    m.when(r.torus, "nodes", r.parts, "Number of nodes of the torus that this rank models.");
    m("device", "OpenCL device of the rank.", [&](Members& d) {
        raya::device_members(d, r.device);
        d("compute_units", r.device.compute_units, "CL_DEVICE_MAX_COMPUTE_UNITS.");
        d("lanes", r.lanes, kLanesMeaning);
        d("group_size", r.group_size, kGroupMeaning);
        d("bytes_taken", r.bytes_taken, "Size of all buffers ever created on the device, bytes.");
    });
    m("build_s", r.build_s, "Build time of the kernels by the rank's clock, s.");
    m("render_s", r.render_s, "Time of everything after the build, by the rank's clock, s.");
    m("messages_sent", r.messages_sent, "Number of messages sent to other ranks during the render.");
    m("bytes_sent", r.bytes_sent, "Total size of the messages sent, bytes.");
    m("waiting_s", r.waiting_s, "Time spent waiting for other ranks, s.");
    m("commands", r.commands, kCommandsMeaning);
    roofline_members(m, r.roofline);
}

namespace {

void image_members(Members& m, const RenderReport& r) {
    m("width", r.image.width, "Width in pixels.");
    m("height", r.image.height, "Height in pixels.");
    m("file", r.image.file, "Image file, as given to --output.");
    m("hash", r.image.hash, kHashMeaning);
    m("exposure", r.image.exposure, "Stops: colours of the file times 2^exposure; null: linear.");
    const auto& preview = r.image.preview;
    m.when(!preview.png.empty(), "preview", "Image for the report's web page, reduced if it is large.",
           [&](Members& p) {
               p("width", preview.width, "Width in pixels.");
               p("height", preview.height, "Height in pixels.");
               p("png", base64(preview.png), "PNG file in base64.");
           });
}

void machine_members(Members& m, const RenderReport& r) {
    const auto& machine = r.machine;
    m("name", machine.name, "Name, as given to --machine.");
    m("topology", machine.topology, "Connections between the PEs: `ring+bus`, `torus3d` or `torus2d`.");
    m("pes", machine.pes, "Number of PEs; on the torus, number of nodes.");
    m("mapping", machine.mapping, "As given to --mapping; `voxels` on the torus.");
    m("offset", machine.offset, "Offset p of the cyclic mapping, pixels; null without an offset.");
    m("fold", machine.fold, "Assignment of slots to PEs, `cyclic` or `block`; null without slots.");
    m("format", machine.format, kFormatMeaning);
    m("length_exponent", machine.length_exponent, "e: lengths of the scene were multiplied by 2^e.");
    m("bounces", machine.bounces, "Maximum number of reflections and refractions after the primary ray.");
    m("pe_memory_bytes", machine.pe_memory_bytes ? std::optional(machine.pe_memory_bytes) : std::nullopt,
      "Memory of a PE in bytes; null if unlimited.");
    m("pe_memory_used_bytes", machine.pe_memory_used_bytes, "Memory used in a PE, or in the fullest node, bytes.");
}

void device_members(Members& m, const RenderReport& r) {
    raya::device_members(m, r.device);
    m("lanes", r.device.lanes, kLanesMeaning);
    m("group_size", r.device.group_size, kGroupMeaning);
    m("tuned", r.device.tuned,
      "Source of lanes and group size: `defaults`, `options`, or a file of raya tune and its date.");
    m("build_options", r.device.build_options, "Options of the kernel compiler.");
}

// Adds the counts of the events whose member in kEvents begins with `prefix`, without the prefix.
void event_members(Members& m, const EventCounts& events, const std::string& prefix) {
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
        const std::string member = kEvents[event].member;
        const bool listed =
            prefix.empty() ? !member.empty() && member.find('.') == std::string::npos : member.starts_with(prefix);
        if (listed) m(member.substr(prefix.size()), events[event], "Number of events (kernels/shared/events.h).");
    }
}

void load_members(Members& m, const RenderReport& r) {
    members_of(m, r.load);
    m("simulated", r.requests.has_value(), "True for dynamic and hybrid mappings, whose distribution is simulated.");
    m.when(r.requests.has_value(), "requests", r.requests.value_or(0), "Requests for pixels in the simulation.");
    for (const auto& [name, meaning] : {std::pair{"trace", "Loads of a ring's first phase, tracing."},
                                        {"supersample", "Loads of a ring's second phase, supersampling."}}) {
        const auto phase = std::ranges::find(r.loads, name, &std::pair<std::string, Load>::first);
        m.when(phase != r.loads.end(), name, phase != r.loads.end() ? phase->second : Load{}, meaning);
    }
}

void measured_members(Members& m, const RenderReport& r) {
    const auto& measured = r.measured;
    m("build_s", measured.build_s, "Build time of the kernels by the host's clock, s.");
    m("render_s", measured.render_s, "Time of everything after the build, by the host's clock, s.");
    m.when(r.accel_s > 0, "accel_s", r.accel_s, "Time to build the grid or BVH on the host, s.");
    m.when(measured.earlier_s > 0, "earlier_s", measured.earlier_s,
           "Part of `render_s` before --resume, without its commands, s.");
    m("commands", measured.commands, kCommandsMeaning);
    m.when(!r.ranks.empty(), "ranks", r.ranks, "Each MPI rank (docs/clusters.md).");
    m.when(measured.roofline.has_value(), "builds", measured.builds, "With --profile or --page: each program.");
    roofline_members(m, measured.roofline);
}

}  // namespace

void members_of(Members& m, const RenderReport& r) {
    m("kind", kRenderReportKind, "Identifies the report: `raya render`.");
    m("raya", r.raya, kVersionMeaning);
    m("scene", r.scene, kSceneMeaning);
    m("warnings", r.warnings, kWarningsMeaning);
    m("skipped", r.skipped, kSkippedMeaning);
    m("view", r.view, kViewMeaning);
    const auto part = [&](void (*list)(Members&, const RenderReport&)) {
        return [&r, list](Members& p) { list(p, r); };
    };
    const auto counts = [&](const char* prefix) {
        return [&r, prefix](Members& p) { event_members(p, r.events, prefix); };
    };
    m("image", part(image_members), "Rendered image.");
    m("machine", part(machine_members), "Modelled machine.");
    m("device", part(device_members), "OpenCL device.");
    m("rays", counts("rays."), "Numbers of rays, counted by the kernels.");
    m("tests", counts("tests."), "Numbers of intersection tests, counted by the kernels.");
    m("shading", counts("shading."), "Numbers of shading events, counted by the kernels.");
    event_members(m, r.events, "");
    m("load", part(load_members),
      "Modelled cycles of the PEs in all phases together, computed from the instruction budget of each event "
      "(host/model/budget.hpp; torus: host/model/t805.hpp). If `simulated` is true, they are the loads of a simulated "
      "distribution of pixels.");
    m.include(r.of_machine.json);
    m("measured", part(measured_members), "Times measured on this host and device.");
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
    for (const auto& [rank] : r.ranks) {
        max_waiting_s = std::max(max_waiting_s, rank.at("waiting_s").get<double>());
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
