#include "host/cli/bench_baseline.hpp"

#include <fmt/core.h>

#include <cstdio>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/report/bench_report.hpp"
#include "host/verify/device_checks.hpp"

namespace raya {
namespace {

Json compared_json(const BaselineOptions& options, const BenchComparison& comparison) {
    Json rows = Json::array();
    for (const ComparedRow& row : comparison.rows) rows.push_back(to_json(row));
    return {{"baseline", options.baseline},
            {"tolerance_percent", options.tolerance_percent},
            {"remarks", comparison.remarks},
            {"compared", comparison.compared},
            {"slower", comparison.slower},
            {"other_images", comparison.other_images},
            {"rows", rows}};
}

}  // namespace

BenchReport read_baseline(const BaselineOptions& options) {
    if (!(options.tolerance_percent >= 0 && options.tolerance_percent <= 100))
        throw UserError(fmt::format("--tolerance {}: must be 0..100 percent", options.tolerance_percent));
    if (options.baseline.empty()) return {};
    return read_bench_report(options.baseline);
}

void check_comparable(const BaselineOptions& options, const BenchReport& baseline, const BenchReport& measured) {
    if (options.baseline.empty() || rows_in_common(baseline, measured) > 0) return;
    const BenchMeasurement &old_row = baseline.rows.front(), &new_row = measured.rows.front();
    throw UserError(fmt::format(
        "{}: contains no row of this run: its first row is {}, {}, {}, {}, {} lanes, group {}; the first row of this "
        "run is {}, {}, {}, {}, {} lanes, group {}; remedy: use the scene and options of the baseline, or write a new "
        "baseline (raya bench --report)",
        options.baseline, old_row.scene, old_row.size, old_row.array, old_row.format, old_row.lanes, old_row.group_size,
        new_row.scene, new_row.size, new_row.array, new_row.format, new_row.lanes, new_row.group_size));
}

void write_and_compare(const BaselineOptions& options, const ReportFiles& files, const BenchReport& baseline,
                       BenchReport measured) {
    if (options.baseline.empty()) return write_report_and_page(files, to_json(measured));
    const BenchComparison comparison = compare_bench(baseline, measured, options.tolerance_percent);
    measured.compared = compared_json(options, comparison);
    write_report_and_page(files, to_json(measured));
    fmt::print("\ncompared with {}, tolerance {} % of its rates:\n{}", printable(options.baseline),
               options.tolerance_percent, comparison.text);
    std::fflush(stdout);
    if (comparison.slower + comparison.other_images > 0)
        throw CheckFailure{fmt::format("{}: {} of {} slower by more than {} %, {} with a different image",
                                       options.baseline, comparison.slower, counted(comparison.compared, "row"),
                                       options.tolerance_percent, comparison.other_images)};
    fmt::print("{} compared, none slower by more than {} %, all images equal\n", counted(comparison.compared, "row"),
               options.tolerance_percent);
}

void add_baseline_options(CLI::App& command, BaselineOptions& options, CLI::Option* build) {
    CLI::Option* compare =
        add_file(command, FileUse::kRead, "--compare", options.baseline, "FILE.json",
                 "Compare the rows with those of an earlier --report: exit code 4 if a row is slower or its image "
                 "differs",
                 "Compare with an earlier report: exit code 4 if slower")
            ->excludes(build);
    add_value(command, "--tolerance", options.tolerance_percent,
              "With --compare: tolerance in percent, 0..100; a row is slower if both its best and its median rate fall "
              "by more than the tolerance")
        ->type_name("PERCENT")
        ->capture_default_str()
        ->needs(compare);
}

}  // namespace raya
