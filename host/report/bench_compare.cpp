#include "host/report/bench_compare.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "host/report/table.hpp"

namespace raya {
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

std::string change_cell(double value) { return fmt::format("{:+.1f} %", value); }

std::vector<std::string> key_cells(const BenchMeasurement& row) {
    return {row.kernel, row.scene, row.size, row.format, std::to_string(row.lanes), std::to_string(row.group_size)};
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
}

std::string rate_cell(double value) { return fmt::format("{:.1f}", value); }

/// Counts a row in `comparison` and returns the verdict on it. `before`, `now`: the row in the baseline and in this
/// run.
std::string count_row(BenchComparison& comparison, const BenchMeasurement& before, const BenchMeasurement& now,
                      double tolerance) {
    const double best_change = percent_change(before.best_rate(), now.best_rate());
    const double median_change = percent_change(before.median_rate(), now.median_rate());
    ++comparison.compared;
    if (now.hash != before.hash) {
        ++comparison.other_images;
        return fmt::format("OTHER IMAGE: {}, was {}", now.hash.substr(0, 8), before.hash.substr(0, 8));
    }
    if (std::max(best_change, median_change) < -tolerance) {
        ++comparison.slower;
        return "SLOWER";
    }
    return std::min(best_change, median_change) > tolerance ? "faster" : "as before";
}

/// Adds a remark and a warning if the two runs have different texts for `property`.
void add_difference(BenchComparison& comparison, const char* property, const std::string& before,
                    const std::string& now) {
    if (before == now) return;
    comparison.remarks.push_back(fmt::format("the {} differs from the baseline's: {}, was {}", property, now, before));
    comparison.text += "warning: " + comparison.remarks.back() + "\n";
}

/// Returns the JSON of a row. `before`, `now`: the row in the baseline and in this run; null: the run has no such row.
Json row_json(const BenchMeasurement* before, const BenchMeasurement* now, const std::string& verdict_text) {
    Json json = row_key_json(now != nullptr ? *now : *before);
    json["mrays_per_s"] = now != nullptr ? rates_json(*now) : Json{};
    json["mrays_per_s_was"] = before != nullptr ? rates_json(*before) : Json{};
    json["verdict"] = verdict_text;
    return json;
}

}  // namespace

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
        const BenchMeasurement* before = find_row(baseline.rows, row);
        const std::string verdict_text =
            before == nullptr ? "not in the baseline" : count_row(comparison, *before, row, tolerance);
        comparison.rows.push_back(row_json(before, &row, verdict_text));
        if (before == nullptr) {
            table.push_back(joined(key_cells(row), {rate_cell(row.best_rate()), "-", "-", rate_cell(row.median_rate()),
                                                    "-", "-", verdict_text}));
            continue;
        }
        table.push_back(joined(key_cells(row),
                               {rate_cell(row.best_rate()), rate_cell(before->best_rate()),
                                change_cell(percent_change(before->best_rate(), row.best_rate())),
                                rate_cell(row.median_rate()), rate_cell(before->median_rate()),
                                change_cell(percent_change(before->median_rate(), row.median_rate())), verdict_text}));
    }
    for (const BenchMeasurement& row : baseline.rows) {
        if (find_row(now.rows, row) != nullptr) continue;
        const std::string verdict_text = "in the baseline alone";
        comparison.rows.push_back(row_json(&row, nullptr, verdict_text));
        table.push_back(joined(key_cells(row), {"-", rate_cell(row.best_rate()), "-", "-", rate_cell(row.median_rate()),
                                                "-", verdict_text}));
    }
    comparison.text += text_table(table);
    return comparison;
}

}  // namespace raya
