// Modelled times of offsets and runs, against plain sums, full routes and real renders.
#include <catch2/catch.hpp>
#include <numeric>

#include "host/model/budget.hpp"
#include "host/ring/route.hpp"
#include "host/study/arrays.hpp"
#include "host/study/measured.hpp"
#include "host/study/paper.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "tests/ring/small_mapping.hpp"

namespace raya {
namespace {

CostImage random_image(SplitMix& random, std::uint32_t width, std::uint32_t height) {
    CostImage image{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i)
        image.cycles.push_back(random.next() % 8 == 0 ? random_below(random, 1'000'003) : random_below(random, 50));
    return image;
}

// Milliseconds of the busiest PE, every pixel asked for its owner.
double busiest_ms(const CostImage& image, const raya_mapping& mapping) {
    std::vector<std::uint64_t> loads(mapping.pes);
    for (std::uint32_t j = 0; j < image.height; ++j)
        for (std::uint32_t x = 0; x < image.width; ++x)
            loads[raya_owner(mapping, j, x)] += image.cycles[j * image.width + x];
    return spa_ms(static_cast<double>(*std::max_element(loads.begin(), loads.end())));
}

TEST_CASE("two rows tell the rotations of all rows", "[study]") {
    const std::uint64_t seed = GENERATE(take(600, random(std::int64_t{0}, std::int64_t{1} << 60)));
    CAPTURE(seed);
    SplitMix random(seed);
    const raya_mapping m = any_mapping(random, 12);
    CAPTURE(m.width, m.height, m.pes, m.parameter, m.kind);
    std::uint64_t turns = 0;
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side)
        for (const Leg& leg : shortest_route(m.pes, neighbour_distances(m, side))) turns += leg.turns();
    CHECK(neighbour_rotations(m) == turns);
}

TEST_CASE("a PE for each column takes 2 (min(p, P - p) + 1) rotations", "[study]") {
    for (const std::uint32_t size : {3u, 8u, 31u, 64u})
        for (std::uint32_t p = 0; p < size; ++p) {
            CAPTURE(size, p);
            const raya_mapping m = cyclic(size, p);
            CHECK(neighbour_rotations(m) == 2 * (std::min(p, size - p) + 1));
        }
}

TEST_CASE("an offset's computing is the busiest PE's by plain sums", "[study]") {
    const std::uint64_t seed = GENERATE(take(200, random(std::int64_t{0}, std::int64_t{1} << 60)));
    CAPTURE(seed);
    SplitMix random(seed);
    const raya_mapping m = small_mapping(random, 14);
    Costs costs;
    costs.trace = random_image(random, m.width, m.height);
    costs.supersample = random_image(random, m.width, m.height);
    for (const AntialiasMethod method :
         {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample}) {
        const auto times = offset_times(costs, m.pes, method, 3);
        REQUIRE(times.size() == m.width);
        for (std::uint32_t p = 0; p < m.width; ++p) {
            const raya_mapping mapping = cyclic(m.width, m.height, m.pes, p);
            const bool again = method == AntialiasMethod::kSupersample;
            CHECK(times[p].trace_ms == Approx(3 * busiest_ms(costs.trace, mapping)).epsilon(1e-12));
            CHECK(times[p].supersample_ms ==
                  Approx(again ? 3 * busiest_ms(costs.supersample, mapping) : 0).epsilon(1e-12));
            CHECK(times[p].rotations == (method == AntialiasMethod::kNone ? 0 : neighbour_rotations(mapping)));
        }
    }
}

TEST_CASE("an offset's time is that of a real run on the ring", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const LabelledScene scene = embedded_scene("centre");
    constexpr std::uint32_t kSize = 24;
    for (const AntialiasMethod method :
         {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample})
        for (const std::uint32_t pes : {24u, 10u, 60u}) {
            const auto times = offset_times(lab.costs(scene, kSize, method), pes, method, 2.5);
            for (const std::uint32_t p : {0u, 5u, 19u}) {
                CAPTURE(static_cast<int>(method), pes, p);
                const SpaRun run = run_on_spa(session, scene, kSize, pes, p, method);
                const ModelledTime time = spa_time(run, 2.5);
                CHECK(run.machine == "spa");
                CHECK(times[p].rotations == run.communication.rotations);
                CHECK(times[p].smooth_ms == Approx(time.filter_ms + time.compare_ms).epsilon(1e-12));
                CHECK(times[p].ring_ms == Approx(time.communication_ms).epsilon(1e-12));
                CHECK(times[p].total_ms() == Approx(time.compute_ms + time.communication_ms).epsilon(1e-12));
            }
        }
}

TEST_CASE("smoothing is charged for the method alone", "[study]") {
    CHECK(smoothing_cycles(AntialiasMethod::kNone, 7).filter == 0);
    CHECK(smoothing_cycles(AntialiasMethod::kNone, 7).compare == 0);
    CHECK(smoothing_cycles(AntialiasMethod::kFilter, 7).filter == filter_cycles(7));
    CHECK(smoothing_cycles(AntialiasMethod::kFilter, 7).compare == 0);
    CHECK(smoothing_cycles(AntialiasMethod::kSupersample, 7).filter == 0);
    CHECK(smoothing_cycles(AntialiasMethod::kSupersample, 7).compare == compare_cycles(7));
}

TEST_CASE("an exchange's set-up is charged once, and never without an exchange", "[study]") {
    Costs costs;
    costs.trace = {64, 64, std::vector<std::uint64_t>(64 * 64, 1000)};
    const auto plain = offset_times(costs, 64, AntialiasMethod::kNone, 1),
               filtered = offset_times(costs, 64, AntialiasMethod::kFilter, 1);
    CHECK(plain[16].ring_ms == 0);
    const double rotation = 10. / 32 - 0.128 + 1e3 * 3 * 64 / 6e6;
    CHECK(filtered[0].ring_ms == Approx(1.375 + 2 * rotation).epsilon(1e-12));
    CHECK(filtered[16].ring_ms == Approx(1.375 + 34 * rotation).epsilon(1e-12));
}

TEST_CASE("the paper's figures stand beside its scene at its size alone", "[study]") {
    CHECK(printed(5, "centre", 256) == 5);
    CHECK_FALSE(printed(5, "centre", 255));
    CHECK_FALSE(printed(5, "centre", 512));
    CHECK_FALSE(printed(5, "scenes/centre.nff", 256));
}

TEST_CASE("of equal offsets the smallest is best", "[study]") {
    std::vector<OffsetTime> times(5);
    const double ms[] = {9, 4, 4, 7, 5};
    for (std::size_t p = 0; p < times.size(); ++p) times[p] = {.offset = std::uint32_t(p), .ring_ms = ms[p]};
    CHECK(least(times, &OffsetTime::total_ms).offset == 1);
}

TEST_CASE("a scene's usual size is its own where square, halved for many objects", "[study]") {
    Scene scene;
    scene.spheres.resize(30);
    const auto size_of = [&](int width, int height) {
        scene.view.width = width;
        scene.view.height = height;
        return usual_size(scene);
    };
    CHECK(size_of(96, 96) == 96);
    CHECK(size_of(512, 512) == 512);
    CHECK(size_of(512, 384) == 256);
    CHECK(size_of(8, 8) == 256);
    scene.spheres.resize(4096);  // 2^12 objects: 2^30 tests at 512
    CHECK(size_of(512, 512) == 512);
    scene.spheres.resize(8196);
    CHECK(size_of(512, 512) == 256);
    CHECK(size_of(64, 64) == 64);
    scene.spheres.resize(1'000'000);
    CHECK(size_of(4096, 4096) == 64);
}

TEST_CASE("measuring stops after its runs or its seconds, and tells least, median and largest", "[study]") {
    const auto told = [](std::vector<double> seconds, int runs, double enough) {
        std::size_t next = 0;
        const Measured m = measure(runs, enough, [&] { return seconds.at(next++); });
        CHECK(m.runs == static_cast<int>(next));
        return m;
    };
    const Measured five = told({3, 1, 2, 5, 4, 0}, 5, 100);
    CHECK(five.runs == 5);
    CHECK(five.min_ms == 1000);
    CHECK(five.median_ms == 3000);
    CHECK(five.max_ms == 5000);
    const Measured two = told({3, 1, 2}, 5, 4);
    CHECK(two.runs == 2);
    CHECK(two.median_ms == 2000);
    CHECK(told({7, 1}, 5, 6).runs == 1);
    CHECK(told({7, 1}, 1, 100).min_ms == 7000);
}

TEST_CASE("a first call warms up and does not count", "[study]") {
    std::vector<double> seconds = {9, 3, 1, 2};
    std::size_t next = 0;
    const Measured m = measure_warm(3, 100, [&] { return seconds.at(next++); });
    CHECK(next == 4);
    CHECK(m.runs == 3);
    CHECK(m.max_ms == 3000);
    CHECK(m.min_ms == 1000);
}

}  // namespace
}  // namespace raya
