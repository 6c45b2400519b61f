// What `raya bench` measured, as a file that a later run can be compared with.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/report/roofline.hpp"

namespace raya {

/// One kernel with one set of options. All but the times and the image's hash say what was measured: two rows that
/// agree there can be compared.
struct BenchMeasurement {
    std::string kernel, scene;  // the scene's file without folder
    std::string size;           // pixels, "512x512"
    std::string array;          // PEs, mapping, bounces, grid: "256 PEs, cyclic:16, 8 bounces, accel none"
    std::string format;
    std::uint32_t lanes = 0, group_size = 0;
    std::uint64_t rays = 0;           // of one image
    double best_s = 0, median_s = 0;  // of one image, > 0: the kernel's on the device, or a whole render's on the host
    int samples = 0;                  // of which these are the best and the median
    std::string hash, build_options = {};  // of the image; as the compiler saw them
    std::optional<Roofline> roofline{};    // of one row, the best sample's; where the device's peak was measured

    double best_rate() const { return static_cast<double>(rays) / best_s * 1e-6; }  // Mrays/s
    double median_rate() const { return static_cast<double>(rays) / median_s * 1e-6; }
};

/// What the driver's compiler took for a program's kernels.
struct BenchBuild {
    std::string kernel, variant, format;  // the program's file; of which render; of which format
    std::uint32_t lanes = 0;
    double build_s = 0, launch_s = 0;  // of the first launches
    std::size_t binary_bytes = 0;
    std::string build_options{};
};

struct BenchReport {
    std::string raya;  // version
    std::string device, platform, version, driver;
    std::vector<BenchMeasurement> rows;
    std::vector<BenchBuild> builds{};  // with --build, which leaves `rows` empty
    Json compared{};  // compare_bench()'s, with the baseline's name; null: held against none
};

/// What was measured, by which rows are compared; and its rates, Mrays/s.
Json measured_json(const BenchMeasurement& row);
Json rates_json(const BenchMeasurement& row);

/// By which a report is known again: its member "kind".
inline constexpr const char* kBenchReportKind = "raya bench";

/// The report, its kind first.
Json to_json(const BenchReport& report);

/// Reads what to_json() made, but for rooflines and comparison. Throws UserError with file, reason and
/// remedy for a file that cannot be read, is no such report, or holds a row that cannot be one.
BenchReport read_bench_report(const std::filesystem::path& path);

}  // namespace raya
