// The family of scenes as heavy as the paper's: figures against plain sums, and that the search met what it sought.
#include <numeric>

#include "host/model/budget.hpp"
#include "host/scene/generate.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"
#include "tests/document.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

double busiest(const CostImage& image, std::uint32_t p) {
    return plain_load(image, image.width,
                      [&](std::uint32_t row, std::uint32_t column) { return sheared(row, column, p, image.width); })
        .max;
}

TEST_CASE("a cluster's times are plain sums on the one clock", "[study]") {
    constexpr std::uint32_t kSize = 40;
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    Scenes scenes;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) scenes.push_back({"mine", generate_cluster(seed)});
    const StudyPage page = study_cluster(lab, scenes);
    check_page(page);
    CHECK(page.claims.empty());
    CHECK(page.settings.find("seeds") == nullptr);  // the family's, which is not here
    for (const Comparison& comparison : page.comparisons) CHECK_FALSE(comparison.paper);
    REQUIRE(page.table("cluster").rows.size() == 5);
    const double ms = 100e-6 * 7 / (256 * 42 * 100e-6);  // of a budget cycle: the filter's 7 ms over its 256 x 42
    double sum = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        const Costs& costs = lab.costs(scenes[i], kSize, AntialiasMethod::kSupersample);
        const auto total = static_cast<double>(
            std::accumulate(costs.trace.cycles.begin(), costs.trace.cycles.end(), std::uint64_t{0}));
        const auto value = [&](const char* label) { return page.value("cluster", i, label); };
        CHECK(value("cycles a pixel") == Approx(total / (kSize * kSize)));
        CHECK(value("1 PE: compute") == Approx(ms * total).epsilon(1e-12));
        CHECK(value("ray tracing, p = 16") == Approx(ms * busiest(costs.trace, 16)).epsilon(1e-12));
        CHECK(value("u(16)") == Approx(busiest(costs.trace, 16) * kSize / total - 1).epsilon(1e-12));
        CHECK(value("recomputed") == Approx(100. * static_cast<double>(costs.recomputed) / (kSize * kSize)));
        CHECK(value("supersampling alone, p = 0") ==
              Approx(ms * (busiest(costs.supersample, 0) + static_cast<double>(compare_cycles(kSize)))).epsilon(1e-12));
        const double rotations = 34 * (10. / 32 - 0.128 + 1e3 * 3 * kSize / 6e6);
        CHECK(value("with the filter, p = 16") ==
              Approx(ms * (busiest(costs.trace, 16) + 42. * kSize) + 1.375 + rotations).epsilon(1e-12));
        sum += value("u(16)") / 5;
    }
    CHECK(page.comparison("u(16)").ours == Approx(sum).epsilon(1e-12));
}

TEST_CASE("the clusters have what they were searched for, by the mean of 64 seeds", "[.][long]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const StudyPage page = study_cluster(lab, {});
    check_page(page);
    const auto near = [&](const char* what) {
        const Comparison& c = page.comparison(what);
        CHECK(c.ours == Approx(c.paper.value()).epsilon(0.1));
    };
    near("u(0)");
    near("pixels recomputed");
    near("1 PE: compute");
    CHECK(page.claims.size() == 8);
}

}  // namespace
}  // namespace raya
