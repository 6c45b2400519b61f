#include "host/report/bench_report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "host/base/whole_file.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

/// Returns the members that identify a row, as a tuple.
auto key(const BenchMeasurement& r) {
    return std::tie(r.kernel, r.scene, r.size, r.array, r.format, r.lanes, r.group_size);
}

BenchReport report_of(const Json& json) {
    const Json* const kind = find_member(json, "kind");
    if (kind == nullptr || !kind->is_string() || json_text(*kind) != kBenchReportKind)
        throw UserError("valid JSON, but not a report of raya bench");
    BenchReport report = from_json<BenchReport>(json);
    if (report.rows.empty()) throw UserError("the report has no measurements");
    std::set<decltype(key(report.rows.front()))> keys;
    for (const BenchMeasurement& row : report.rows) {
        const std::string name = fmt::format("row with {} and {} lanes", row.format, row.lanes);
        if (row.best_s <= 0 || row.median_s <= 0 || row.rays == 0)
            throw UserError(name + ": rays and times must be positive");
        if (!keys.insert(key(row)).second) throw UserError(name + " occurs twice");
    }
    return report;
}

/// Adds the members that identify a row.
template <class Row>
void key_members(Members& m, Row& row) {
    m("kernel", row.kernel, "Kernel, or `render, VARIANT`. This and the members up to `group` identify the row.");
    m("scene", row.scene, "Scene file without folder.");
    m("size", row.size, "Width x height in pixels.");
    m("array", row.array, "Number of PEs, mapping, number of bounces and accelerator.");
    m("format", row.format, kFormatMeaning);
    m("lanes", row.lanes, kLanesMeaning);
    m("group", row.group_size, kGroupMeaning);
}

constexpr const char* kOptionsMeaning = "Options of the kernel compiler.";

using Rows = std::vector<BenchMeasurement>;

const BenchMeasurement* find_row(const Rows& rows, const BenchMeasurement& wanted) {
    const auto found = std::ranges::find_if(rows, [&](const auto& row) { return key(row) == key(wanted); });
    return found == rows.end() ? nullptr : &*found;
}

/// Returns the change of a rate in percent.
double percent_change(double before, double now) { return 100 * (now / before - 1); }

/// Counts a row of both runs in `comparison`, and sets its verdict.
void count_row(BenchComparison& comparison, ComparedRow& row, double tolerance) {
    const double best_change = percent_change(row.before->best_rate(), row.now->best_rate());
    const double median_change = percent_change(row.before->median_rate(), row.now->median_rate());
    ++comparison.compared;
    row.has_failed = true;
    if (row.now->hash != row.before->hash) {
        ++comparison.other_images;
        row.verdict = fmt::format("OTHER IMAGE: {}, was {}", row.now->hash.substr(0, 8), row.before->hash.substr(0, 8));
    } else if (std::max(best_change, median_change) < -tolerance) {
        ++comparison.slower;
        row.verdict = "SLOWER";
    } else {
        row.verdict = std::min(best_change, median_change) > tolerance ? "faster" : "as before";
        row.has_failed = false;
    }
}

/// Returns the table's cells of a row: its key, then for both rates this run, the baseline and the change.
std::vector<std::string> cells_of(const ComparedRow& row) {
    const BenchMeasurement& key = row.now != nullptr ? *row.now : *row.before;
    std::vector<std::string> cells = {
        key.kernel, key.scene, key.size, key.format, std::to_string(key.lanes), std::to_string(key.group_size)};
    for (const auto rate : {&BenchMeasurement::best_rate, &BenchMeasurement::median_rate}) {
        for (const BenchMeasurement* run : {row.now, row.before})
            cells.push_back(run != nullptr ? fmt::format("{:.1f}", (run->*rate)()) : "-");
        const bool has_both = row.now != nullptr && row.before != nullptr;
        cells.push_back(has_both ? fmt::format("{:+.1f} %", percent_change((row.before->*rate)(), (row.now->*rate)()))
                                 : "-");
    }
    cells.push_back(row.verdict);
    return cells;
}

/// Adds a remark and a warning if the two runs have different texts for `property`.
void add_difference(BenchComparison& comparison, const char* property, const std::string& before,
                    const std::string& now) {
    if (before == now) return;
    comparison.remarks.push_back(fmt::format("the {} differs from the baseline's: {}, was {}", property, now, before));
    comparison.text += "warning: " + comparison.remarks.back() + "\n";
}

}  // namespace

/// Millions of rays of all kinds per second.
struct BenchRates {
    double best = 0, median = 0;
};

static void members_of(Members& m, const BenchRates& rates) {
    m("best", rates.best, "Rate of the fastest sample, Mrays/s.");
    m("median", rates.median, "Rate of the sample with the median time, Mrays/s.");
}

static void members_of(Members& m, BenchMeasurement& row) {
    key_members(m, row);
    m("rays", row.rays, "Number of rays of one image.");
    m("mrays_per_s", BenchRates{row.best_rate(), row.median_rate()}, "Millions of rays of all kinds per second.");
    double best_ms = 1e3 * row.best_s, median_ms = 1e3 * row.median_s;
    m("ms",
      "Time for one image. Kernels: time of the kernel by the device's clock. With `--variants`: time of the whole "
      "render by the host's clock.",
      [&](Members& ms) {
          ms("best", best_ms, "Time of the fastest sample, ms.");
          ms("median", median_ms, "Median time of the samples, ms.");
      });
    if (m.reads()) row.best_s = 1e-3 * best_ms, row.median_s = 1e-3 * median_ms;
    m("samples", row.samples, "Number of samples.");
    m("hash", row.hash, kHashMeaning);
    m("build_options", row.build_options, kOptionsMeaning);
    roofline_members(m, row.roofline);
}

static void members_of(Members& m, BenchBuild& build) {
    m("kernel", build.kernel, "File of the program in kernels/.");
    m("variant", build.variant, "Variant that uses the program: `none`, `grid`, `bvh` or `torus`.");
    m("format", build.format, kFormatMeaning);
    m("lanes", build.lanes, kLanesMeaning);
    m("build_s", build.build_s, "Time of clBuildProgram, s.");
    m("first_launch_s", build.launch_s, "First launches of its kernels, with compilation at launch, s.");
    m("build_options", build.build_options, kOptionsMeaning);
}

void members_of(Members& m, const ComparedRow& row) {
    const auto rates = [](const BenchMeasurement* of) {
        return of ? std::optional(BenchRates{of->best_rate(), of->median_rate()}) : std::nullopt;
    };
    const BenchMeasurement none;
    key_members(m, row.now ? *row.now : row.before ? *row.before : none);
    m("mrays_per_s", rates(row.now), "Rates in this report; null if only the earlier report has the row.");
    m("mrays_per_s_was", rates(row.before), "Rates in the earlier report; null if it lacks the row.");
    m("verdict", row.verdict,
      "`as before`, `faster`, `SLOWER`, `OTHER IMAGE: ...`, or which report alone has the row.");
}

static void members_of(Members& m, const BenchComparison& c) {
    m("baseline", c.baseline, "File of the earlier report.");
    m("tolerance_percent", c.tolerance_percent, "Decrease that does not count as slower, percent.");
    m("remarks", c.remarks, "Differences of device, driver or version of raya.");
    m("compared", c.compared, "Number of rows that both reports have.");
    m("slower", c.slower, "Number of rows whose best and median rates both fell by more than the tolerance.");
    m("other_images", c.other_images, "Number of rows with another image hash.");
    m("rows", c.rows, "Rows of this report and of the earlier report; one entry for a row that both have.");
}

void members_of(Members& m, BenchReport& report) {
    m("kind", kBenchReportKind, "Identifies the report: `raya bench`.");
    m("raya", report.raya, kVersionMeaning);
    m("device", "OpenCL device.", [&](Members& device) { device_members(device, report.device); });
    m("rows", report.rows, "One row for each kernel or variant, format and number of lanes; empty with `--build`.");
    m.when(!report.builds.empty(), "builds", report.builds, "With --build: each program, variant and format.");
    m.when(report.compared.has_value(), "compared", report.compared.value_or(BenchComparison{}),
           "With --compare: comparison with an earlier report.");
}

BenchReport read_bench_report(const fs::path& path) {
    const JsonSource source{input_name(path), "make a baseline with: raya bench --report " + path.string()};
    return read_json(json_file_text(path, source), source, report_of);
}

int rows_in_common(const BenchReport& baseline, const BenchReport& now) {
    return static_cast<int>(
        std::ranges::count_if(now.rows, [&](const auto& row) { return find_row(baseline.rows, row) != nullptr; }));
}

BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance) {
    BenchComparison comparison;
    comparison.tolerance_percent = tolerance;
    add_difference(comparison, "device", baseline.device.platform + " " + baseline.device.name,
                   now.device.platform + " " + now.device.name);
    add_difference(comparison, "driver", baseline.device.version + ", " + baseline.device.driver,
                   now.device.version + ", " + now.device.driver);
    add_difference(comparison, "version of raya", baseline.raya, now.raya);
    std::vector<std::vector<std::string>> table = {{"kernel", "scene", "size", "format", "lanes", "group",
                                                    "best Mrays/s", "was", "change", "median", "was", "change", ""}};
    for (const BenchMeasurement& row : now.rows) {
        ComparedRow both{find_row(baseline.rows, row), &row, "not in the baseline"};
        if (both.before != nullptr) count_row(comparison, both, tolerance);
        comparison.rows.push_back(both);
    }
    for (const BenchMeasurement& row : baseline.rows)
        if (find_row(now.rows, row) == nullptr) comparison.rows.push_back({&row, nullptr, "in the baseline alone"});
    for (const ComparedRow& row : comparison.rows) table.push_back(cells_of(row));
    comparison.text += text_table(table);
    return comparison;
}

}  // namespace raya
