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
double change(double before, double now) { return 100 * (now / before - 1); }

std::string percent(double value) { return fmt::format("{:+.1f} %", value); }

std::vector<std::string> key_cells(const BenchMeasurement& row) {
    return {row.kernel, row.scene, row.size, row.format, std::to_string(row.lanes), std::to_string(row.group_size)};
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
}

std::string rate(double value) { return fmt::format("{:.1f}", value); }

/// Returns the verdict on a row that both runs have, and counts it in `sum`.
std::string verdict(BenchComparison& sum, const BenchMeasurement& before, const BenchMeasurement& now,
                    double tolerance) {
    const double best = change(before.best_rate(), now.best_rate());
    const double median = change(before.median_rate(), now.median_rate());
    ++sum.compared;
    if (now.hash != before.hash) {
        ++sum.other_images;
        return fmt::format("OTHER IMAGE: {}, was {}", now.hash.substr(0, 8), before.hash.substr(0, 8));
    }
    if (std::max(best, median) < -tolerance) {
        ++sum.slower;
        return "SLOWER";
    }
    return std::min(best, median) > tolerance ? "faster" : "as before";
}

/// Adds a remark if the two texts differ.
void add_difference(BenchComparison& sum, const char* what, const std::string& before, const std::string& now) {
    if (before == now) return;
    sum.remarks.push_back(fmt::format("another {}: {}, the baseline's is {}", what, now, before));
    sum.text += "warning: " + sum.remarks.back() + "\n";
}

/// `before`, `now`: null if the run does not have the row.
Json row_json(const BenchMeasurement* before, const BenchMeasurement* now, const std::string& verdict_text) {
    Json json = measured_json(now != nullptr ? *now : *before);
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
    BenchComparison sum;
    add_difference(sum, "device", baseline.platform + " " + baseline.device, now.platform + " " + now.device);
    add_difference(sum, "driver", baseline.version + ", " + baseline.driver, now.version + ", " + now.driver);
    add_difference(sum, "version of raya", baseline.raya, now.raya);
    std::vector<std::vector<std::string>> table = {{"kernel", "scene", "size", "format", "lanes", "group",
                                                    "best Mrays/s", "was", "change", "median", "was", "change", ""}};
    for (const BenchMeasurement& row : now.rows) {
        const BenchMeasurement* before = find_row(baseline.rows, row);
        const std::string text = before == nullptr ? "not in the baseline" : verdict(sum, *before, row, tolerance);
        sum.rows.push_back(row_json(before, &row, text));
        if (before == nullptr) {
            table.push_back(
                joined(key_cells(row), {rate(row.best_rate()), "-", "-", rate(row.median_rate()), "-", "-", text}));
            continue;
        }
        table.push_back(joined(key_cells(row), {rate(row.best_rate()), rate(before->best_rate()),
                                                percent(change(before->best_rate(), row.best_rate())),
                                                rate(row.median_rate()), rate(before->median_rate()),
                                                percent(change(before->median_rate(), row.median_rate())), text}));
    }
    for (const BenchMeasurement& row : baseline.rows) {
        if (find_row(now.rows, row) != nullptr) continue;
        const std::string text = "in the baseline alone";
        sum.rows.push_back(row_json(&row, nullptr, text));
        table.push_back(
            joined(key_cells(row), {"-", rate(row.best_rate()), "-", "-", rate(row.median_rate()), "-", text}));
    }
    sum.text += text_table(table);
    return sum;
}

}  // namespace raya
