#include "host/cli/bench_baseline.hpp"

#include <fmt/core.h>

#include <cstdio>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/report/bench_compare.hpp"
#include "host/verify/ci_reports.hpp"

namespace raya {
namespace {

// Returns a check for each row of the comparison: "bench trace, spheres.nff, 512x512, ARRAY, fp32, 16 lanes, group 1".
// Its time is the median time of one image.
DeviceChecks checks_of(const BenchComparison& comparison, const BenchReport& report,
                       const std::vector<ExpectedFailure>& expected_failures) {
    DeviceChecks device{.name = report.device,
                        .platform = report.platform,
                        .version = report.version,
                        .driver = report.driver,
                        .names = {},
                        .checks = {}};
    for (const ComparedRow& row : comparison.rows) {
        const BenchMeasurement& m = row.now ? *row.now : *row.before;
        const auto rates = [](const BenchMeasurement* of) {
            return of ? fmt::format("best {:.1f}, median {:.1f} Mrays/s", of->best_rate(), of->median_rate())
                      : "not measured";
        };
        Check check{"bench",
                    fmt::format("{}, {}, {}, {}, {}, {} lanes, group {}", m.kernel, m.scene, m.size, m.array, m.format,
                                m.lanes, m.group_size),
                    row.now ? m.median_s : 0,
                    {row.has_failed          ? Outcome::kFail
                     : row.now && row.before ? Outcome::kPass
                                             : Outcome::kSkip,
                     fmt::format("{}: {}; baseline: {}", row.verdict, rates(row.now), rates(row.before))}};
        apply_expectations(check, expected_failures);
        device.seconds += check.seconds;
        device.checks.push_back(check);
    }
    return device;
}

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

Baseline read_baseline(const BaselineOptions& options) {
    if (!(options.tolerance_percent >= 0 && options.tolerance_percent <= 100))
        throw UserError(fmt::format("--tolerance {}: must be 0..100 percent", options.tolerance_percent));
    if (options.baseline.empty()) {
        if (!options.junit.empty() || !options.tap.empty() || !options.expect.empty())
            throw UserError("--junit, --tap, --expect: need --compare");
        return {};
    }
    return {read_bench_report(options.baseline), read_expected_failures(options.expect)};
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

void write_and_compare(const BaselineOptions& options, const ReportFiles& files, const Baseline& baseline,
                       BenchReport measured) {
    if (options.baseline.empty()) return write_report_and_page(files, to_json(measured));
    const BenchComparison comparison = compare_bench(baseline.report, measured, options.tolerance_percent);
    const std::vector<DeviceChecks> devices = {checks_of(comparison, measured, baseline.expected_failures)};
    const std::vector<Check>& checks = devices.front().checks;
    measured.compared = compared_json(options, comparison);
    write_report_and_page(files, to_json(measured));
    if (!options.junit.empty()) write_whole_file(options.junit, junit_report("raya bench", devices));
    if (!options.tap.empty()) write_whole_file(options.tap, tap_report(devices));
    fmt::print("\ncompared with {}, tolerance {} % of its rates:\n{}", printable(options.baseline),
               options.tolerance_percent, comparison.text);
    for (const Check& check : checks)
        if (has_expectation(check.verdict.outcome)) fmt::print("{}", check_lines(check));
    std::fflush(stdout);
    for (const std::string& text : unmatched_patterns(baseline.expected_failures, devices)) warn(text);
    const std::size_t expected = count_of(checks, Outcome::kExpectedFail),
                      unexpected = count_of(checks, Outcome::kUnexpectedPass);
    const std::string as_listed =
        expected + unexpected == 0 ? "" : fmt::format("; --expect: {} as listed, {} not slower", expected, unexpected);
    if (!devices.front().all_passed())
        throw CheckFailure{fmt::format("{}: {} of {} slower by more than {} %, {} with a different image{}",
                                       options.baseline, comparison.slower, counted(comparison.compared, "row"),
                                       options.tolerance_percent, comparison.other_images, as_listed)};
    if (expected > 0)
        fmt::print("{} compared{}\n", counted(comparison.compared, "row"), as_listed);
    else
        fmt::print("{} compared, none slower by more than {} %, all images equal\n",
                   counted(comparison.compared, "row"), options.tolerance_percent);
}

void add_baseline_options(CLI::App& command, BaselineOptions& options, CLI::Option* build) {
    CLI::Option* compare =
        add_file(command, FileUse::kRead, "--compare", options.baseline, "FILE.json",
                 "Compare the rows with those of an earlier --report: exit code 4 if a row is slower or its image "
                 "differs")
            ->excludes(build);
    add_value(command, "--tolerance", options.tolerance_percent,
              "With --compare: tolerance in percent, 0..100; a row is slower if both its best and its median rate fall "
              "by more than the tolerance")
        ->type_name("PERCENT")
        ->capture_default_str()
        ->needs(compare);
    add_file(
        command, FileUse::kRead, "--expect", options.expect, "FILE",
        "With --compare: rows that are known to be slower or different, one on each line: PATTERN | REASON | LINK, "
        "with a pattern of the row's name in --tap; they do not count; if one is as before, the exit code is 4");
    add_file(command, FileUse::kWritten, "--junit", options.junit, "FILE.xml",
             "With --compare: write the comparison as JUnit XML, one test case for each row");
    add_file(command, FileUse::kWritten, "--tap", options.tap, "FILE",
             "With --compare: write the comparison as TAP, version 14");
}

}  // namespace raya
