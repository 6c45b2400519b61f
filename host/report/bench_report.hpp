// Report of `raya bench`: written as JSON, and read as the baseline of a later run.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/report/roofline.hpp"

namespace raya {

/// Measurement of one kernel with one set of options. Two rows can be compared if all members of measured_json() are
/// equal.
struct BenchMeasurement {
    std::string kernel, scene;  // scene: file name without folder
    std::string size;           // pixels, "512x512"
    std::string array;          // PEs, mapping, bounces, grid: "256 PEs, cyclic:16, 8 bounces, accel none"
    std::string format;
    std::uint32_t lanes = 0, group_size = 0;
    std::uint64_t rays = 0;           // of one image
    double best_s = 0, median_s = 0;  // for one image, > 0: kernel time on the device, or of a whole render on the host
    int samples = 0;                  // from which best and median are taken
    std::string hash, build_options = {};  // hash of the image; options as passed to the compiler
    std::optional<Roofline> roofline{};    // one row, of the best sample; if the device's peak was measured

    double best_rate() const { return static_cast<double>(rays) / best_s * 1e-6; }  // Mrays/s
    double median_rate() const { return static_cast<double>(rays) / median_s * 1e-6; }
};

/// Build of a program by the driver's compiler.
struct BenchBuild {
    std::string kernel, variant, format;  // program file, variant of the render, number format
    std::uint32_t lanes = 0;
    double build_s = 0, launch_s = 0;  // launch_s: first launches
    std::size_t binary_bytes = 0;
    std::string build_options{};
};

struct BenchReport {
    std::string raya;  // version
    std::string device, platform, version, driver;
    std::vector<BenchMeasurement> rows;
    std::vector<BenchBuild> builds{};  // with --build, which leaves `rows` empty
    Json compared{};                   // result of compare_bench(), with the baseline's name; null: no comparison
};

/// Members that identify a row; rates in Mrays/s.
Json measured_json(const BenchMeasurement& row);
Json rates_json(const BenchMeasurement& row);

/// Member "kind" of a report, which identifies it.
inline constexpr const char* kBenchReportKind = "raya bench";

/// The report, its kind first.
Json to_json(const BenchReport& report);

/// Reads a report, except rooflines and comparison. Throws UserError with file, reason and remedy if the file cannot be
/// read, is not a report of raya bench, or has an invalid row.
BenchReport read_bench_report(const std::filesystem::path& path);

}  // namespace raya
