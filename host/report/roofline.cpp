#include "host/report/roofline.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/base/json.hpp"
#include "host/model/budget.hpp"
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
    RooflineRow row{.work = work, .seconds = seconds, .host_counts = launches.host_counts};
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

// Returns the value with `digits` decimals, or "-" for NaN.
std::string known(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

std::string host_counts_table(const Roofline& roofline) {
    std::vector<std::vector<std::string>> rows = {{"kernel", "cores", "Gcycles", "Ginstr", "instr/cycle", "instr/op",
                                                   "Mcache misses", "Mbranch misses", "page faults"}};
    for (const RooflineRow& row : roofline.rows) {
        if (!row.host_counts) return {};
        const auto& n = row.host_counts->of;
        const double operations = as_double(row.work.all_operations());
        rows.push_back({row.work.label, known(1e-9 * n[kCpuNs] / row.seconds, 2), known(1e-9 * n[kCycles], 4),
                        known(1e-9 * n[kInstructions], 4), known(n[kInstructions] / n[kCycles], 2),
                        operations > 0 ? known(n[kInstructions] / operations, 2) : "-",
                        known(1e-6 * n[kCacheMisses], 3), known(1e-6 * n[kBranchMisses], 3), known(n[kPageFaults], 0)});
    }
    const std::string& unavailable = roofline.host_counts_unavailable;
    return "\n" + text_table(rows) +
           "cores   processor time of all threads / time of the kernel; this column and the others count user code\n" +
           (unavailable.empty() ? "" : "counts  " + unavailable + "\n");
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
    return text + host_counts_table(roofline);
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

namespace {

Json host_counts_json(const HostCounts& counts) {
    const auto count = [&](HostEvent event) {
        return std::isnan(counts.of[event]) ? Json() : Json(std::llround(counts.of[event]));
    };
    return {{"cycles", count(kCycles)},
            {"instructions", count(kInstructions)},
            {"cache_misses", count(kCacheMisses)},
            {"branch_misses", count(kBranchMisses)},
            {"processor_ns", count(kCpuNs)},
            {"page_faults", count(kPageFaults)}};
}

}  // namespace

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
        if (r.host_counts) rows.back()["host_counts"] = host_counts_json(*r.host_counts);
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

}  // namespace raya
