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
