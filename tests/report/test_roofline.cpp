// Tests of the roofline model, with figures that can be calculated by hand.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/model/budget.hpp"
#include "host/report/render_report.hpp"
#include "host/report/table.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

using Catch::Contains;

const DevicePeak kPeak = {.fp32_per_s = 100e9,
                          .format = "e6m15",
                          .multiply_per_s = 10e9,
                          .divide_per_s = 1e9,
                          .sqrt_per_s = 2e9,
                          .copy_bytes_per_s = 20e9,
                          .copy_bytes = 256 << 20};

LabelSummary kernel(const std::string& label, std::uint64_t ns) {
    return {.label = label, .kind = "kernel", .launches = 2, .total_ns = ns, .min_ns = 1, .mean_ns = 2.0, .max_ns = 3};
}

RooflineRow row_of(const KernelWork& work, std::uint64_t ns, const DevicePeak& peak = kPeak) {
    const Roofline all = roofline(peak, {work}, {kernel(work.label, ns)});
    REQUIRE(all.rows.size() == 1);
    return all.rows.front();
}

}  // namespace

TEST_CASE("roofline: a kernel with many operations is compute bound", "[report]") {
    const KernelWork work = {
        .label = "trace", .rays = 5, .operations = 970, .divisions = 20, .roots = 10, .bytes = 100};
    const RooflineRow row = row_of(work, 100);
    CHECK(row.bound == std::string("compute"));
    CHECK(row.intensity == Approx(10));
    CHECK(row.roof_fraction == Approx(0.1));  // 1000 operations in 100 ns: 10 Gop/s of 100 Gop/s
    REQUIRE(row.format_fraction);
    // 970 operations at 10 Gop/s take 97 ns, 20 divisions at 1 Gop/s 20 ns, 10 square roots at 2 Gop/s 5 ns.
    CHECK(*row.format_fraction == Approx((97 + 20 + 5) / 100.0));
}

TEST_CASE("roofline: a kernel with many bytes is bandwidth bound", "[report]") {
    const RooflineRow row = row_of({.label = "move", .operations = 0, .bytes = 1000}, 100);
    CHECK(row.bound == std::string("bandwidth"));
    CHECK(row.roof_fraction == Approx(0.5));  // 10 GB/s of 20 GB/s
    CHECK_FALSE(row.format_fraction);
    // The ridge point is 100 Gop/s / 20 GB/s = 5 operations per byte.
    CHECK(row_of({.label = "a", .operations = 501, .bytes = 100}, 1).bound == std::string("compute"));
    CHECK(row_of({.label = "a", .operations = 499, .bytes = 100}, 1).bound == std::string("bandwidth"));
}

TEST_CASE("roofline: has rows only for kernels that ran and were timed", "[report]") {
    const KernelWork work = {.label = "a", .operations = 1};
    CHECK(roofline(kPeak, {work}, {}).rows.empty());
    CHECK(roofline(kPeak, {work}, {kernel("b", 1)}).rows.empty());
    CHECK(roofline(kPeak, {work}, {kernel("a", 0)}).rows.empty());
    LabelSummary copy = kernel("a", 1);
    copy.kind = "copy";
    CHECK(roofline(kPeak, {work}, {copy}).rows.empty());
    CHECK(roofline({}, {work}, {kernel("a", 1)}).rows.empty());
    CHECK_THAT(roofline_table(roofline({}, {work}, {kernel("a", 1)})), Contains("does not time"));
}

TEST_CASE("work_of: sums the budgets of the events", "[report]") {
    EventCounts events{};
    events[RAYA_SPHERE_TESTS] = 10;
    events[RAYA_PLANE_TESTS] = 3;
    events[RAYA_PRIMARY] = 2;
    events[RAYA_SHADOW] = 1;
    const KernelWork work = work_of("trace", events);
    CHECK(work.rays == 3);
    // Budgets in operations: a sphere test 12, a plane test 7, a primary ray 12, a shadow ray 12.
    CHECK(work.operations == 10 * 12 + 3 * 7 + 2 * 12 + 1 * 12);
    CHECK(work.divisions == 3 + 2 + 1);
    CHECK(work.roots == 2 + 1);
    CHECK(work.all_operations() == 177 + 6 + 3);
}

TEST_CASE("roofline_table: contains the bound of each kernel and its percentage of the roof", "[report]") {
    const Roofline all = roofline(
        kPeak, {{.label = "trace", .rays = 5, .operations = 1000, .bytes = 100}, {.label = "route", .bytes = 1000}},
        {kernel("trace", 100), kernel("route", 100)});
    const std::string table = roofline_table(all);
    CAPTURE(table);
    CHECK_THAT(table, Contains("compute        10.00") && Contains("bandwidth      50.00"));
    CHECK(to_json(all.rows[0]).at("rays_per_s") == Approx(5e7));
    CHECK(to_json(all.rows[0]).at("operations_per_s") == Approx(1e10));
    CHECK(to_json(all.rows[1]).at("share_of_format").is_null());
}

TEST_CASE("profile_table: lists builds and waiting times separately from commands", "[report]") {
    LabelSummary c = kernel("trace", 2'000'000);
    c.submit_ns = 3'000'000;
    c.start_ns = 5'000'000;
    c.bytes = 7;
    const std::string table = profile_table(1.5, {{"ring/trace.cl", 1.25}}, {c});
    CAPTURE(table);
    CHECK_THAT(table, Catch::StartsWith("kernel build 1.500 s, not among the commands: ring/trace.cl 1.250 s;"));
    CHECK_THAT(table, Contains("2.000    100.0"));
    CHECK_THAT(table, Contains("1.500             2.500  0.000  0.000\n"));
    CHECK(to_json(c).at("queue_to_submit_mean_ns") == 1.5e6);
    CHECK(to_json(c).at("submit_to_start_mean_ns") == 2.5e6);
}

}  // namespace raya
