// Report of `raya bench`: written as JSON, and read again as the baseline of a later run.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/report/roofline.hpp"

namespace raya {

/// Measurement of one kernel with one set of options: a row of the report. Two rows are comparable if measured_json()
/// is equal for both.
struct BenchMeasurement {
    std::string kernel, scene;  // scene: file name without folder
    std::string size;           // pixels, "512x512"
    std::string array;          // PEs, mapping, bounces, grid: "256 PEs, cyclic:16, 8 bounces, accel none"
    std::string format;
    std::uint32_t lanes = 0, group_size = 0;
    std::uint64_t rays = 0;           // number of rays of one image
    double best_s = 0, median_s = 0;  // per image, > 0: kernel time on the device, or host time of a whole render
    int samples = 0;                  // number of samples
    std::string hash, build_options = {};  // image hash; options passed to the compiler
    std::optional<Roofline> roofline{};    // one row, of the best sample; empty: the peak was not measured

    double best_rate() const { return static_cast<double>(rays) / best_s * 1e-6; }  // Mrays/s
    double median_rate() const { return static_cast<double>(rays) / median_s * 1e-6; }
};

/// Measurement of the driver's compiler building one program.
struct BenchBuild {
    std::string kernel, variant, format;  // kernel file, renderer variant, number format
    std::uint32_t lanes = 0;
    double build_s = 0, launch_s = 0;  // build_s: compilation; launch_s: first launches
    std::size_t binary_bytes = 0;
    std::string build_options{};
};

struct BenchReport {
    std::string raya;  // version
    std::string device, platform, version, driver;
    std::vector<BenchMeasurement> rows;
    std::vector<BenchBuild> builds{};  // with --build; `rows` is then empty
    Json compared{};                   // result of compare_bench() with the baseline's name; null: none
};

/// JSON members of a row: measured_json() those that identify it, rates_json() its rates in Mrays/s.
Json measured_json(const BenchMeasurement& row);
Json rates_json(const BenchMeasurement& row);

/// Value of the member "kind", which identifies the report.
inline constexpr const char* kBenchReportKind = "raya bench";

/// Returns the report; "kind" is the first member.
Json to_json(const BenchReport& report);

/// Reads a report without its rooflines and comparison. Throws UserError with file, reason and remedy if the file
/// cannot be read, is not a report of raya bench, or has an invalid row.
BenchReport read_bench_report(const std::filesystem::path& path);

}  // namespace raya
