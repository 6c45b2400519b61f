// Compares two runs of `raya bench` row by row: rates and images.
#pragma once
#include <string>
#include <vector>

#include "host/report/bench_report.hpp"

namespace raya {

struct BenchComparison {
    std::string text;                    // warnings, and a table of all rows of both runs
    int compared = 0;                    // rows in both runs
    int slower = 0;                      // of these: slower by more than the tolerance
    int other_images = 0;                // of these: with another hash
    Json rows = Json::list();            // all rows: key, rates now and before, verdict
    std::vector<std::string> remarks{};  // differences of device, driver and version
    bool failed() const { return slower + other_images > 0; }
};

/// Number of rows of `now` that the baseline also has.
int rows_in_common(const BenchReport& baseline, const BenchReport& now);

/// Compares `now` with `baseline`. A row is slower if its best and its median rate have both dropped by more than
/// `tolerance` percent: a disturbance by other programs affects one of them, a slower kernel both. Another image is a
/// failure at any rate. Another device, driver or version of raya gives a warning; rows in only one run are listed.
BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance);

}  // namespace raya
