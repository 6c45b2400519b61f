// Report of `raya bench`: written as JSON, and read again as the baseline of a later run.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/members.hpp"
#include "host/cl/device.hpp"
#include "host/report/render_report.hpp"

namespace raya {

/// Measurement of one kernel with one set of options: a row of the report. Two rows are comparable if the
/// members from `kernel` to `group_size` are equal.
struct BenchMeasurement {
    std::string kernel, scene;  // scene: file name without folder
    std::string size;           // pixels, "512x512"
    std::string array;          // machine settings: "256 PEs, cyclic:16, 8 bounces, accel none"
    std::string format;
    std::uint32_t lanes = 0, group_size = 0;
    std::uint64_t rays = 0;              // number of rays of one image
    double best_s = 0, median_s = 0;     // seconds per image, > 0: kernel time on the device, or host time of a render
    int samples = 0;                     // number of samples
    std::string hash;                    // of the image
    std::string build_options = {};      // options passed to the compiler
    std::optional<Roofline> roofline{};  // one row: the best sample; empty: the peak was not measured

    double best_rate() const { return static_cast<double>(rays) / best_s * 1e-6; }  // Mrays/s
    double median_rate() const { return static_cast<double>(rays) / median_s * 1e-6; }
};

/// Times and size of one program that the driver's compiler builds.
struct BenchBuild {
    std::string kernel, variant, format;  // kernel file; variant that uses the program; number format
    std::uint32_t lanes = 0;
    double build_s = 0;   // seconds of compilation
    double launch_s = 0;  // seconds of the first launches, summed over the program's kernels
    std::string build_options{};
};

// Compares the rates and images of two runs of `raya bench`, row by row.

/// A row in the baseline and in this run. Null: the run has no such row.
struct ComparedRow {
    const BenchMeasurement *before = nullptr, *now = nullptr;
    std::string verdict;      // "as before", "faster", "SLOWER", "OTHER IMAGE: ...", or which run alone has the row
    bool has_failed = false;  // slower, or another image
};

/// Result of compare_bench().
struct BenchComparison {
    std::string text;                    // for the terminal: warnings, and a table with the rows of both runs
    int compared = 0;                    // number of rows that both runs have
    int slower = 0;                      // number of compared rows that are slower by more than the tolerance
    int other_images = 0;                // number of compared rows with different image hashes
    std::vector<ComparedRow> rows{};     // rows of both runs; they point into the reports
    std::vector<std::string> remarks{};  // the warnings: differences of device, driver or version
    std::string baseline{};              // name of the baseline's file
    double tolerance_percent = 0;        // of the rates
    bool failed() const { return slower + other_images > 0; }
};

struct BenchReport {
    std::string raya;  // version of raya
    DeviceInfo device;
    std::vector<BenchMeasurement> rows{};
    std::vector<BenchBuild> builds{};           // with --build; `rows` is then empty
    std::optional<BenchComparison> compared{};  // with the rows of this report and of the baseline
};

/// Value of the member "kind", which identifies the report.
inline constexpr const char* kBenchReportKind = "raya bench";

// Lists of the members, for to_json(), schema_of() and from_json(), which ignores rooflines and comparison.
void members_of(Members& m, const ComparedRow& row);
void members_of(Members& m, BenchReport& report);

/// Reads a report. Throws UserError with file, reason and remedy if the file
/// cannot be read, is not a report of raya bench, or has an invalid row.
BenchReport read_bench_report(const std::filesystem::path& path);

/// Returns the number of rows of `now` that the baseline also has.
int rows_in_common(const BenchReport& baseline, const BenchReport& now);

/// Compares `now` with `baseline`. A row counts as slower if both its best and its median rate are lower by more than
/// `tolerance` percent. A slower kernel lowers both rates, whereas other programs on the device often lower only one. A
/// different image is a failure regardless of the rates. A different device, driver or version of raya causes a
/// warning. The table also lists rows that only one run has.
BenchComparison compare_bench(const BenchReport& baseline, const BenchReport& now, double tolerance);

}  // namespace raya
