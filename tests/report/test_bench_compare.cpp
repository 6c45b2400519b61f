// Tests of the reports of raya bench: reading, refused files, and comparison with a baseline.
#include <catch2/catch.hpp>
#include <fstream>
#include <random>

#include "host/error.hpp"
#include "host/report/bench_report.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {
using Catch::Matchers::Contains;

BenchMeasurement row(std::uint32_t lanes, double best_ms, double median_ms) {
    return {.kernel = "trace",
            .scene = "spheres",
            .size = "512x512",
            .array = "256 PEs, cyclic:16, 8 bounces, accel none",
            .format = "fp32",
            .lanes = lanes,
            .group_size = 1,
            .rays = 1'000'000,
            .best_s = best_ms * 1e-3,
            .median_s = median_ms * 1e-3,
            .samples = 7,
            .hash = "0123456789abcdef",
            .build_options = "-cl-std=CL1.2"};
}

BenchReport report(std::vector<BenchMeasurement> rows) {
    return {.raya = "0.1.0",
            .device = {.name = "cpu", .platform = "PoCL", .version = "OpenCL 3.0", .driver = "3.1", .type = ""},
            .rows = std::move(rows)};
}

// Returns the error message of read_bench_report() for a file with this text, or "accepted".
std::string refusal(const ScratchFolder& folder, const std::string& text) {
    std::ofstream(folder / "b.json") << text;
    try {
        read_bench_report(folder / "b.json");
    } catch (const UserError& error) {
        return error.what();
    }
    return "accepted";
}

TEST_CASE("read_bench_report: inverts to_json", "[bench]") {
    const ScratchFolder folder;
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        CAPTURE(i);
        BenchReport written = report({});
        for (unsigned n = 0; n < 1 + random() % 8; ++n) {
            const auto ms = [&] { return 1e-3 * std::uniform_int_distribution(1, 1'000'000)(random); };
            written.rows.push_back(row(n, ms(), ms()));
            written.rows.back().rays = random();
            written.rows.back().scene = "scene " + std::to_string(random());
        }
        std::ofstream(folder / "b.json") << to_json(written).dump();
        const BenchReport read = read_bench_report(folder / "b.json");
        CHECK(read.device.driver == written.device.driver);
        REQUIRE(read.rows.size() == written.rows.size());
        // The file contains milliseconds. The conversion from seconds to milliseconds and back may change a time's last
        // bit, so the comparison has a tolerance.
        CHECK(rows_in_common(read, written) == static_cast<int>(written.rows.size()));
        const BenchComparison comparison = compare_bench(read, written, 1e-9);
        CHECK(comparison.compared == static_cast<int>(written.rows.size()));
        CHECK_FALSE(comparison.failed());
    }
}

TEST_CASE("read_bench_report: refuses files that are not valid reports, and names the reason", "[bench]") {
    const ScratchFolder folder;
    const std::string good = to_json(report({row(1, 2, 3)})).dump();
    const auto changed = [&](const auto& change) {
        Document json = Document::parse(good);
        change(json);
        return json.dump();
    };
    CHECK(refusal(folder, good) == "accepted");
    CHECK_THROWS_WITH(read_bench_report(folder.path()), Contains("it is a directory"));
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"kernel,lanes\n", "b.json: not valid JSON: parse error at line 1"},
        {R"({"scene": "centre.nff"})", "b.json: valid JSON, but not a report of raya bench"},
        {changed([](auto& j) { j["rows"].clear(); }), "the report has no measurements"},
        {changed([](auto& j) { j.erase("device"); }), "b.json: key 'device' not found"},
        {changed([](auto& j) { j["rows"][0]["lanes"] = "many"; }),
         "b.json: (/rows/0/lanes) must be a whole number from 0"},
        {changed([](auto& j) { j["rows"].push_back(j["rows"][0]); }), "occurs twice"}};
    for (const auto& [text, reason] : cases) CHECK_THAT(refusal(folder, text), Contains(reason));
    for (const char* part : {"best", "median"})
        for (const double bad : {0.0, -1.0})
            CHECK_THAT(refusal(folder, changed([&](auto& j) { j["rows"][0]["ms"][part] = bad; })),
                       Contains("rays and times must be positive"));
}

TEST_CASE("compare_bench: a row is slower if best and median rate both fall by more than the tolerance", "[bench]") {
    struct Case {
        double best, median;  // rates divided by those of the baseline, whose times are 10 and 12 ms
        double tolerance;     // percent
        bool slower;
    };
    const std::vector<Case> cases = {{1, 1, 10, false},       {0.89, 0.89, 10, true}, {0.91, 0.91, 10, false},
                                     {0.5, 1, 10, false},     {1, 0.5, 10, false},    {0.91, 0.5, 10, false},
                                     {0.89, 0.91, 10, false}, {2, 2, 0, false},       {0.99, 0.99, 0, true},
                                     {0.89, 0.89, 12, false}, {0.01, 0.01, 98, true}, {0.01, 0.01, 100, false}};
    for (const Case& c : cases) {
        CAPTURE(c.best, c.median, c.tolerance);
        const BenchComparison result =
            compare_bench(report({row(4, 10, 12)}), report({row(4, 10 / c.best, 12 / c.median)}), c.tolerance);
        CHECK(result.compared == 1);
        CHECK(result.slower == (c.slower ? 1 : 0));
        CHECK(result.other_images == 0);
        CHECK(result.failed() == c.slower);
        CHECK((result.text.find("SLOWER") != std::string::npos) == c.slower);
    }
}

TEST_CASE("compare_bench: the comparison fails if the images differ, however fast the kernel is", "[bench]") {
    BenchMeasurement other = row(4, 1, 1);
    other.hash = "fedcba9876543210";
    const BenchComparison result = compare_bench(report({row(4, 10, 10)}), report({other}), 100);
    CHECK(result.failed());
    CHECK(result.other_images == 1);
    CHECK(result.slower == 0);
    CHECK_THAT(result.text, Contains("OTHER IMAGE: fedcba98, was 01234567"));
}

TEST_CASE("compare_bench: a different device causes a warning, and rows that only one run has are listed", "[bench]") {
    BenchReport now = report({row(4, 10, 10), row(8, 10, 10)});
    now.device.name = "gpu";
    const BenchComparison result = compare_bench(report({row(1, 10, 10), row(4, 10, 10)}), now, 10);
    CHECK_FALSE(result.failed());
    CHECK(result.compared == 1);
    CHECK_THAT(result.text, Contains("warning: the device differs from the baseline's: PoCL gpu, was PoCL cpu\n") &&
                                Contains("not in the baseline") && Contains("in the baseline alone"));
    CHECK(result.text.find("another driver") == std::string::npos);
    now.device.driver = "4.0";
    CHECK_THAT(compare_bench(report({row(4, 10, 10)}), now, 10).text,
               Contains("warning: the driver differs from the baseline's: OpenCL 3.0, 4.0, was OpenCL 3.0, 3.1"));
}

TEST_CASE("rows_in_common: rows match if all members up to the group size are equal", "[bench]") {
    const BenchReport baseline = report({row(4, 10, 10)});
    const auto in_common = [&](const auto& change) {
        BenchMeasurement other = row(4, 20, 30);
        change(other);
        return rows_in_common(baseline, report({other}));
    };
    CHECK(in_common([](auto& r) { r.hash = "x", r.build_options = "y", r.samples = 1; }) == 1);
    for (const auto text : {&BenchMeasurement::kernel, &BenchMeasurement::scene, &BenchMeasurement::size,
                            &BenchMeasurement::array, &BenchMeasurement::format})
        CHECK(in_common([&](auto& r) { r.*text = "x"; }) == 0);
    for (const auto number : {&BenchMeasurement::lanes, &BenchMeasurement::group_size})
        CHECK(in_common([&](auto& r) { r.*number = 2; }) == 0);
}

}  // namespace
}  // namespace raya
