// `raya bench --compare`: compares the rows with those of an earlier report.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/cli/page.hpp"
#include "host/report/bench_report.hpp"

namespace raya {

struct BaselineOptions {
    std::string baseline;  // file of --compare
    double tolerance_percent = 10;
};

/// Adds --compare, which excludes the option `build`, and --tolerance, which needs --compare.
void add_baseline_options(CLI::App& command, BaselineOptions& options, CLI::Option* build);

/// Returns the report of --compare; without --compare, an empty one. Throws UserError if the file or the tolerance is
/// not valid. Called before the measurements, so that an error is reported before they take their time.
BenchReport read_baseline(const BaselineOptions& options);

/// Throws UserError if the baseline has no row of this run.
void check_comparable(const BaselineOptions& options, const BenchReport& baseline, const BenchReport& measured);

/// Compares with the baseline, if there is one. Writes all files, and prints the comparison. Throws CheckFailure if a
/// row is slower or has a different image.
void write_and_compare(const BaselineOptions& options, const ReportFiles& files, const BenchReport& baseline,
                       BenchReport measured);

}  // namespace raya
