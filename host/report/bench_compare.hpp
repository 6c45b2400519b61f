// Two runs of `raya bench`, row against row: what became slower, faster, or another image.
#pragma once
#include <string>
#include <vector>

#include "host/report/bench_report.hpp"

namespace raya {

struct BenchComparison {
    std::string text;                    // warnings, and a table with a line for each row of either side
    int compared = 0;                    // rows that both sides have
    int slower = 0;                      // of these, past the tolerance
    int other_images = 0;                // of these, with another hash
    Json rows = Json::list();            // of either side: what was measured, rates now and before, the verdict
    std::vector<std::string> remarks{};  // another device, driver, version
    bool failed() const { return slower + other_images > 0; }
};

/// How many rows of `now` the baseline has as well.
int rows_in_common(const BenchReport& baseline, const BenchReport& now);

/// Rates of `now` against those of `baseline`. A row is slower where its best and its median have both lost more than
/// `tolerance` percent of their rate: a disturbance from outside moves one of them, a slower kernel both. Another
/// device, driver or version of raya is a warning, a row that one side lacks a remark; another image is a failure,
/// whatever its time.
BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance);

}  // namespace raya
