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

/// Returns the JSON object with the rates of a row in Mrays/s.
Json rates_json(const BenchMeasurement& row) { return {{"best", row.best_rate()}, {"median", row.median_rate()}}; }

/// Returns the JSON members that identify a row.
Json row_key_json(const BenchMeasurement& row) {
    return {{"kernel", row.kernel}, {"scene", row.scene}, {"size", row.size},       {"array", row.array},
            {"format", row.format}, {"lanes", row.lanes}, {"group", row.group_size}};
}

Json row_json(const BenchMeasurement& row) {
    Json json = row_key_json(row);
    json["rays"] = row.rays;
    json["mrays_per_s"] = rates_json(row);
    json["ms"] = {{"best", 1e3 * row.best_s}, {"median", 1e3 * row.median_s}};
    json["samples"] = row.samples;
    json["hash"] = row.hash;
    json["build_options"] = row.build_options;
    if (!row.roofline) return json;
    if (!row.roofline->unavailable.empty()) json["no_roofline"] = row.roofline->unavailable;
    if (row.roofline->rows.empty()) return json;
    json["peak"] = peak_json(row.roofline->peak);
    json["roofline"] = roofline_json(*row.roofline).front();
    return json;
}

BenchMeasurement row_of(const Json& json) {
    const auto text = [&](const char* key) { return json_text(json.at(key)); };
    const auto number = [&](const char* key) {
        return static_cast<std::uint32_t>(json_integer(json.at(key), INT32_MAX));
    };
    return {.kernel = text("kernel"),
            .scene = text("scene"),
            .size = text("size"),
            .array = text("array"),
            .format = text("format"),
            .lanes = number("lanes"),
            .group_size = number("group"),
            .rays = json_integer(json.at("rays")),
            .best_s = json_number(json.at("ms").at("best")) * 1e-3,
            .median_s = json_number(json.at("ms").at("median")) * 1e-3,
            .samples = static_cast<int>(number("samples")),
            .hash = text("hash"),
            .build_options = text("build_options")};
}

bool is_valid_time(double seconds) { return seconds > 0; }  // JSON has no infinite numbers

BenchReport report_of(const Json& json) {
    const Json* const kind = find_member(json, "kind");
    if (kind == nullptr || !kind->is_string() || json_text(*kind) != kBenchReportKind)
        throw UserError("valid JSON, but not a report of raya bench");
    const Json& device = json.at("device");
    BenchReport report{.raya = json_text(json.at("raya")),
                       .device = json_text(device.at("name")),
                       .platform = json_text(device.at("platform")),
                       .version = json_text(device.at("version")),
                       .driver = json_text(device.at("driver")),
                       .rows = {}};
    for (const Json& row : json_array(json.at("rows"))) report.rows.push_back(row_of(row));
    if (report.rows.empty()) throw UserError("the report has no measurements");
    std::set<std::string> keys;
    for (const BenchMeasurement& row : report.rows) {
        const std::string name = fmt::format("row with {} and {} lanes", row.format, row.lanes);
        if (!is_valid_time(row.best_s) || !is_valid_time(row.median_s) || row.rays == 0)
            throw UserError(name + ": rays and times must be positive");
        if (!keys.insert(row_key_json(row).dump()).second) throw UserError(name + " occurs twice");
    }
    return report;
}

}  // namespace

Json to_json(const BenchReport& report) {
    Json rows = Json::array();
    for (const BenchMeasurement& row : report.rows) rows.push_back(row_json(row));
    Json json = {{"kind", kBenchReportKind},
                 {"raya", report.raya},
                 {"device",
                  {{"name", report.device},
                   {"platform", report.platform},
                   {"version", report.version},
                   {"driver", report.driver}}},
                 {"rows", rows}};
    Json builds = Json::array();
    for (const BenchBuild& build : report.builds)
        builds.push_back({{"kernel", build.kernel},
                          {"variant", build.variant},
                          {"format", build.format},
                          {"lanes", build.lanes},
                          {"build_s", build.build_s},
                          {"first_launch_s", build.launch_s},
                          {"build_options", build.build_options}});
    if (!report.builds.empty()) json["builds"] = builds;
    if (!report.compared.is_null()) json["compared"] = report.compared;
    return json;
}

BenchReport read_bench_report(const fs::path& path) {
    const JsonSource source{input_name(path), "make a baseline with: raya bench --report " + path.string()};
    return read_json(json_file_text(path, source), source, report_of);
}

namespace {

using Rows = std::vector<BenchMeasurement>;

/// Returns the members that identify a row, as a tuple.
auto key(const BenchMeasurement& r) {
    return std::tie(r.kernel, r.scene, r.size, r.array, r.format, r.lanes, r.group_size);
}

const BenchMeasurement* find_row(const Rows& rows, const BenchMeasurement& wanted) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return key(row) == key(wanted); });
    return found == rows.end() ? nullptr : &*found;
}

/// Returns the change of a rate in percent.
double percent_change(double before, double now) { return 100 * (now / before - 1); }

std::vector<std::string> key_cells(const BenchMeasurement& row) {
    return {row.kernel, row.scene, row.size, row.format, std::to_string(row.lanes), std::to_string(row.group_size)};
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
}

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

/// Returns the table's cells of a rate: this run, the baseline, the change.
std::vector<std::string> rate_cells(const ComparedRow& row, double (BenchMeasurement::*rate)() const) {
    const auto cell = [&](const BenchMeasurement* of) { return of ? fmt::format("{:.1f}", (of->*rate)()) : "-"; };
    const bool has_both = row.now != nullptr && row.before != nullptr;
    return {cell(row.now), cell(row.before),
            has_both ? fmt::format("{:+.1f} %", percent_change((row.before->*rate)(), (row.now->*rate)())) : "-"};
}

/// Adds a remark and a warning if the two runs have different texts for `property`.
void add_difference(BenchComparison& comparison, const char* property, const std::string& before,
                    const std::string& now) {
    if (before == now) return;
    comparison.remarks.push_back(fmt::format("the {} differs from the baseline's: {}, was {}", property, now, before));
    comparison.text += "warning: " + comparison.remarks.back() + "\n";
}

}  // namespace

Json to_json(const ComparedRow& row) {
    Json json = row_key_json(row.now != nullptr ? *row.now : *row.before);
    json["mrays_per_s"] = row.now != nullptr ? rates_json(*row.now) : Json{};
    json["mrays_per_s_was"] = row.before != nullptr ? rates_json(*row.before) : Json{};
    json["verdict"] = row.verdict;
    return json;
}

int rows_in_common(const BenchReport& baseline, const BenchReport& now) {
    return static_cast<int>(std::count_if(now.rows.begin(), now.rows.end(),
                                          [&](const auto& row) { return find_row(baseline.rows, row) != nullptr; }));
}

BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance) {
    BenchComparison comparison;
    add_difference(comparison, "device", baseline.platform + " " + baseline.device, now.platform + " " + now.device);
    add_difference(comparison, "driver", baseline.version + ", " + baseline.driver, now.version + ", " + now.driver);
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
    for (const ComparedRow& row : comparison.rows)
        table.push_back(joined(joined(key_cells(row.now != nullptr ? *row.now : *row.before),
                                      rate_cells(row, &BenchMeasurement::best_rate)),
                               joined(rate_cells(row, &BenchMeasurement::median_rate), {row.verdict})));
    comparison.text += text_table(table);
    return comparison;
}

}  // namespace raya
