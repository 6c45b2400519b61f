#include "host/report/bench_report.hpp"

#include <fmt/core.h>

#include <set>

#include "host/base/json.hpp"
#include "host/base/standard_streams.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

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
    json["roofline"] = roofline_json(*row.roofline).elements().front();
    return json;
}

BenchMeasurement row_of(const Json& json) {
    const auto text = [&](const char* key) { return json.at(key).text(); };
    const auto number = [&](const char* key) { return static_cast<std::uint32_t>(json.at(key).integer(INT32_MAX)); };
    return {.kernel = text("kernel"),
            .scene = text("scene"),
            .size = text("size"),
            .array = text("array"),
            .format = text("format"),
            .lanes = number("lanes"),
            .group_size = number("group"),
            .rays = json.at("rays").integer(),
            .best_s = json.at("ms").at("best").number() * 1e-3,
            .median_s = json.at("ms").at("median").number() * 1e-3,
            .samples = static_cast<int>(number("samples")),
            .hash = text("hash"),
            .build_options = text("build_options")};
}

bool is_valid_time(double seconds) { return seconds > 0; }  // JSON has no infinite numbers

BenchReport report_of(const Json& json) {
    const Json* const kind = json.find("kind");
    if (kind == nullptr || !kind->is_text() || kind->text() != kBenchReportKind)
        throw JsonError("valid JSON, but not a report of raya bench");
    const Json& device = json.at("device");
    BenchReport report{.raya = json.at("raya").text(),
                       .device = device.at("name").text(),
                       .platform = device.at("platform").text(),
                       .version = device.at("version").text(),
                       .driver = device.at("driver").text(),
                       .rows = {}};
    for (const Json& row : json.at("rows").elements()) report.rows.push_back(row_of(row));
    if (report.rows.empty()) throw JsonError("the report has no measurements");
    std::set<std::string> keys;
    for (const BenchMeasurement& row : report.rows) {
        const std::string name = fmt::format("row with {} and {} lanes", row.format, row.lanes);
        if (!is_valid_time(row.best_s) || !is_valid_time(row.median_s) || row.rays == 0)
            throw JsonError(name + ": rays and times must be positive");
        if (!keys.insert(row_key_json(row).dump()).second) throw JsonError(name + " occurs twice");
    }
    return report;
}

}  // namespace

Json row_key_json(const BenchMeasurement& row) {
    return {{"kernel", row.kernel}, {"scene", row.scene}, {"size", row.size},       {"array", row.array},
            {"format", row.format}, {"lanes", row.lanes}, {"group", row.group_size}};
}

Json rates_json(const BenchMeasurement& row) { return {{"best", row.best_rate()}, {"median", row.median_rate()}}; }

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

}  // namespace raya
