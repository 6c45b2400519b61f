// Compares the rates and images of two runs of `raya bench`, row by row.
#pragma once
#include <string>
#include <vector>

#include "host/report/bench_report.hpp"

namespace raya {

/// A row in the baseline and in this run. Null: the run has no such row.
struct ComparedRow {
    const BenchMeasurement *before, *now;
    std::string verdict;      // "as before", "faster", "SLOWER", "OTHER IMAGE: ...", or which run alone has the row
    bool has_failed = false;  // slower, or another image
};

/// Returns the row's key, the rates of both runs, and the verdict.
Json to_json(const ComparedRow& row);

/// Result of compare_bench().
struct BenchComparison {
    std::string text;                    // for the terminal: warnings, and a table with the rows of both runs
    int compared = 0;                    // number of rows that both runs have
    int slower = 0;                      // number of compared rows that are slower by more than the tolerance
    int other_images = 0;                // number of compared rows with different image hashes
    std::vector<ComparedRow> rows{};     // rows of both runs; they point into the reports
    std::vector<std::string> remarks{};  // the warnings: differences of device, driver or version
    bool failed() const { return slower + other_images > 0; }
};

/// Returns the number of rows of `now` that the baseline also has.
int rows_in_common(const BenchReport& baseline, const BenchReport& now);

/// Compares `now` with `baseline`. A row counts as slower if both its best and its median rate are lower by more than
/// `tolerance` percent. A slower kernel lowers both rates, whereas other programs on the device often lower only one. A
/// different image is a failure regardless of the rates. A different device, driver or version of raya causes a
/// warning. The table also lists rows that only one run has.
BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance);

}  // namespace raya
