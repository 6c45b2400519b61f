// Compares the rates and images of two runs of `raya bench`, row by row.
#pragma once
#include <string>
#include <vector>

#include "host/report/bench_report.hpp"

namespace raya {

struct BenchComparison {
    std::string text;                    // warnings, then a table with the rows of both runs
    int compared = 0;                    // number of rows that both runs have
    int slower = 0;                      // number of these that are slower by more than the tolerance
    int other_images = 0;                // number of these with another image hash
    Json rows = Json::array();           // rows of both runs: key, rates now and before, verdict
    std::vector<std::string> remarks{};  // differences of device, driver or version
    bool failed() const { return slower + other_images > 0; }
};

/// Returns the number of rows of `now` that the baseline also has.
int rows_in_common(const BenchReport& baseline, const BenchReport& now);

/// Compares `now` with `baseline`. A row counts as slower if both its best and its median rate are lower by more than
/// `tolerance` percent: other programs disturb only one of them, a slower kernel affects both. A different image is a
/// failure regardless of the rates. A different device, driver or version of raya gives a warning. Rows that only one
/// run has are listed.
BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance);

}  // namespace raya
