// `raya bench --compare`: compares the rows with those of an earlier report, and writes the results for CI systems.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/cli/page.hpp"
#include "host/report/bench_report.hpp"
#include "host/verify/verify.hpp"

namespace raya {

struct BaselineOptions {
    std::string baseline, junit, tap, expect;  // files of --compare, --junit, --tap and --expect
    double tolerance_percent = 10;
};

/// Adds --compare, which excludes the option `build`, and --tolerance, --junit, --tap and --expect, which need
/// --compare.
void add_baseline_options(CLI::App& command, BaselineOptions& options, CLI::Option* build);

/// Contents of the files of --compare and --expect.
struct Baseline {
    BenchReport report;
    std::vector<ExpectedFailure> expected_failures;
};

/// Returns the contents of the files; without --compare, nothing. Throws UserError if a file or the tolerance is not
/// valid. Called before the measurements, so that an error is reported before they take their time.
Baseline read_baseline(const BaselineOptions& options);

/// Throws UserError if the baseline has no row of this run.
void check_comparable(const BaselineOptions& options, const BenchReport& baseline, const BenchReport& measured);

/// Compares with the baseline, if there is one. Writes all files, and prints the comparison. Throws CheckFailure if a
/// row is slower or has a different image, or if neither is true of a row that --expect lists.
void write_and_compare(const BaselineOptions& options, const ReportFiles& files, const Baseline& baseline,
                       BenchReport measured);

}  // namespace raya
