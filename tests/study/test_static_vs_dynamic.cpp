// Static against dynamic distribution: strategies on cost images made by hand, and a verdict that follows the figures.
#include <catch2/catch.hpp>
#include <numeric>

#include "host/study/arrays.hpp"
#include "host/study/static_vs_dynamic.hpp"
#include "host/study/studies.hpp"
#include "tests/document.hpp"
#include "tests/ring/small_mapping.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

bool holds(const std::vector<std::string>& findings, const std::string& text) {
    StudyPage page;
    page.findings = findings;
    return says(page, text);
}

CostImage even_image(std::uint32_t size, std::uint64_t cost) {
    return {size, size, std::vector<std::uint64_t>(size * size, cost)};
}

// Two numbers of PEs, a strategy of each kind, their makespans over a lower bound of 1000 cycles.
SceneOutcomes by_hand(std::array<double, 2> fixed, std::array<double, 2> hybrid) {
    SceneOutcomes scene{"hand", {128, 256}, {}, {}, {1, 1}};
    for (const char* name : {"column split", "cyclic, p = 16", "cyclic, p = sqrt(P)"})
        scene.strategies.push_back({name, StrategyKind::kStatic, {}, {}});
    scene.strategies.push_back({"dynamic:1", StrategyKind::kDynamic, {}, {1, 5, 0}});
    scene.strategies.push_back({"hybrid:16, free requests", StrategyKind::kHybrid, {}, {16, 0, 0.5}});
    scene.strategies.push_back({"hybrid:16", StrategyKind::kHybrid, {}, {16, 5, 0.5}});
    const auto outcomes = [](std::array<double, 2> over) {
        std::vector<StrategyOutcome> all;
        for (const double o : over) all.push_back({static_cast<std::uint64_t>(1000 * o), 1 / o, o, 0, false});
        return all;
    };
    const std::array<double, 2> worst = {9, 9}, free = {1, 1};
    scene.outcomes = {outcomes(worst), outcomes(fixed), outcomes(worst),
                      outcomes(worst), outcomes(free),  outcomes(hybrid)};
    return scene;
}

TEST_CASE("a round trip on the SPA: two synchronisations and three words", "[study]") {
    // 0.3125 ms - 768 words / 6 Mword/s = 0.1845 ms, twice; 0.5 us. In cycles of 100 ns: 1845 + 1845 + 5.
    CHECK(round_trip_cycles(machine_named("spa"), 1) == 3695);
    CHECK(round_trip_cycles(machine_named("spa"), 6.5) == 568);  // 568.5: fewer cycles, each as much longer
}

TEST_CASE("strategies are the same by name and kind for every number of PEs, and legal", "[study]") {
    for (const std::uint32_t size : {16u, 20u, 33u, 64u}) {
        const auto first = strategies(size, 1, 7);
        for (const std::uint32_t pes : {2u, 7u, 64u, 128u, 256u}) {
            const auto all = strategies(size, pes, 7);
            REQUIRE(all.size() == first.size());
            for (std::size_t s = 0; s < all.size(); ++s) {
                CAPTURE(size, pes, all[s].name);
                CHECK(all[s].name == first[s].name);
                CHECK(all[s].kind == first[s].kind);
                CHECK(all[s].mapping.pes == pes);
                CHECK(all[s].mapping.width == size);
                CHECK((all[s].kind == StrategyKind::kHybrid) == (all[s].plan.static_share > 0));
                CHECK((all[s].name.find("free") == std::string::npos) ==
                      (all[s].kind == StrategyKind::kStatic || all[s].plan.overhead == 7));
            }
        }
    }
    CHECK(mapping_text(strategies(512, 128, 0)[5].mapping) == "grid:8x16");
    CHECK(mapping_text(strategies(512, 12, 0)[5].mapping) == "grid:3x4");
    CHECK(mapping_text(strategies(512, 256, 0)[5].mapping) == "grid:16x16");
    CHECK(mapping_text(strategies(512, 13, 0)[5].mapping) == "grid:1x13");
    CHECK(mapping_text(strategies(512, 256, 0)[2].mapping) == "cyclic:16");
    CHECK(mapping_text(strategies(64, 4096, 0)[2].mapping) == "cyclic:0");
}

TEST_CASE("outcomes keep the bounds, and static ones are plain sums", "[study]") {
    const std::uint64_t seed = GENERATE(take(100, random(std::int64_t{0}, std::int64_t{1} << 60)));
    CAPTURE(seed);
    SplitMix random(seed);
    const std::uint32_t size = 16 + 4 * random_below(random, 5), pes = 1 + random_below(random, 200);
    CostImage image = even_image(size, 0);
    for (std::uint64_t& cost : image.cycles)
        cost = random.next() % 16 == 0 ? random_below(random, 100'000) : random_below(random, 9);
    const double total =
        static_cast<double>(std::accumulate(image.cycles.begin(), image.cycles.end(), std::uint64_t{0}));
    for (const Strategy& strategy : strategies(size, pes, random_below(random, 300))) {
        CAPTURE(strategy.name, size, pes);
        const StrategyOutcome outcome = run_strategy(image, strategy);
        CHECK(outcome.makespan >= lower_bound(image, pes));
        CHECK(outcome.efficiency == Approx(total / (pes * double(outcome.makespan))).epsilon(1e-12));
        CHECK(outcome.over_bound == Approx(double(outcome.makespan) / double(lower_bound(image, pes))).epsilon(1e-12));
        if (strategy.kind != StrategyKind::kStatic) {
            CHECK(outcome.requests > 0);
            continue;
        }
        std::vector<std::uint64_t> loads(pes);
        for (std::uint32_t j = 0; j < size; ++j)
            for (std::uint32_t x = 0; x < size; ++x)
                loads[raya_owner(strategy.mapping, j, x)] += image.cycles[j * size + x];
        CHECK(outcome.makespan == *std::max_element(loads.begin(), loads.end()));
        CHECK(outcome.requests == 0);
    }
}

TEST_CASE("single columns are found where p meets the turns of the PEs that share a slot", "[study]") {
    const CostImage image = even_image(32, 1);
    const auto single = [&](std::uint32_t p, std::uint32_t pes) {
        return run_strategy(image, {"", StrategyKind::kStatic, cyclic(32, 32, pes, p), {}}).single_columns;
    };
    CHECK(single(0, 32));
    CHECK(single(0, 128));
    CHECK_FALSE(single(0, 16));
    CHECK_FALSE(single(8, 32));
    CHECK_FALSE(single(8, 64));  // 2 PEs a slot, p comes round after 4 rows
    CHECK(single(8, 128));       // 4 and 4
    CHECK(single(8, 256));
    CHECK_FALSE(single(3, 128));
    CHECK_FALSE(run_strategy(even_image(2, 1), {"", StrategyKind::kStatic, cyclic(2, 1), {}}).single_columns);
}

TEST_CASE("the verdict counts what it says", "[study]") {
    const StaticVerdict holds_in_all = verdict_of({by_hand({1.5, 2}, {1.05, 1.1})});
    CHECK(holds_in_all.cases == 2);
    CHECK(holds_in_all.static_inadequate == 2);
    CHECK(holds_in_all.hybrid_optimal == 2);
    CHECK(holds_in_all.hybrid_beats == 2);
    const StaticVerdict in_none = verdict_of({by_hand({1.02, 1.1}, {1.3, 1.1})});
    CHECK(in_none.static_inadequate == 0);
    CHECK(in_none.hybrid_optimal == 1);
    CHECK(in_none.hybrid_beats == 0);  // equal is not better
    const StaticVerdict both = verdict_of({by_hand({1.5, 2}, {1.05, 1.1}), by_hand({1.02, 1.2}, {1.3, 1.3})});
    CHECK(both.cases == 4);
    CHECK(both.static_inadequate == 3);
}

TEST_CASE("findings branch with the figures", "[study]") {
    const auto of = [](const SceneOutcomes& scene) { return dynamic_findings({scene}, 5); };
    CHECK(holds(of(by_hand({1.5, 2}, {1.05, 1.1})), "from 128 PEs on holds here: in 2 of 2"));
    CHECK(holds(of(by_hand({1.5, 2}, {1.05, 1.1})), "within 10 % of the lower bound for every P"));
    CHECK(holds(of(by_hand({1.02, 1.1}, {1.3, 1.1})), "does not hold here: in 0 of 2"));
    CHECK(holds(of(by_hand({1.02, 1.1}, {1.3, 1.1})), "not within 10 % of the lower bound at P = 128"));
    CHECK(holds(of(by_hand({1.02, 1.2}, {1.05, 1.3})), "holds in part here: in 1 of 2"));
    CHECK(holds(of(by_hand({1.02, 1.2}, {1.05, 1.3})), "up to P = 128; at worst the best of them ends 1.30 times"));
    CHECK(holds(of(by_hand({1.02, 1.2}, {1.05, 1.3})), "under 90 % from P = 256 and under 50 % at no P"));

    SceneOutcomes scene = by_hand({1.5, 2}, {1.05, 1.1});
    CHECK_FALSE(holds(of(scene), "No better than the column split"));
    scene.outcomes[2][1].single_columns = true;
    CHECK(holds(of(scene), "No better than the column split can be: cyclic, p = sqrt(P) at P = 256."));
    CHECK(holds(of(scene), "hybrid:16 at no P"));
    scene.outcomes[5][1].requests = 221;  // 1105 cycles of requests, the run takes 1100
    CHECK(holds(of(scene), "hybrid:16 from P = 256"));
    CHECK(first_below(scene, 1, 0.6) == 256);
    CHECK(first_below(scene, 1, 0.7) == 128);
    CHECK(first_below(scene, 1, 0.5) == 0);
}

TEST_CASE("an even image is no case for dynamic distribution", "[study]") {
    const SceneOutcomes scene = outcomes_of("even", even_image(32, 1000), {128, 256, 512}, 300);
    CHECK(scene.bound == std::vector<double>{1, 1, 1});
    const StaticVerdict verdict = verdict_of({scene});
    CHECK(verdict.cases == 3);
    CHECK(verdict.static_inadequate == 0);
    CHECK(verdict.hybrid_beats == 0);
}

TEST_CASE("the study of static and dynamic distribution is whole", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 32);
    const StudyPage page = study_static_vs_dynamic(lab, {});
    check_page(page);
    CHECK(read_back(page.settings)["pes"] == std::vector<int>{128, 256, 512, 1024});
    CHECK(read_back(page.settings)["scenes"].size() == 3);
    CHECK(page.plots.size() == 6);
    REQUIRE(page.table("static-vs-dynamic-factors").rows.size() == 3);  // 1, the clock's, 8
    CHECK(page.value("static-vs-dynamic-factors", 0, "request") == 3695);
    CHECK(page.value("static-vs-dynamic-factors", 2, "request") == 462);  // 461.9
    CHECK(page.claims.size() == 2);
    const auto count = strategies(32, 128, 0).size();
    CHECK(page.table("static-vs-dynamic").rows.size() == 3 * 4 * count);
    CHECK(page.table("static-vs-dynamic-1").rows.size() == count + 1);
    const StudyPage one = study_static_vs_dynamic(lab, {embedded_scene("glass")});
    CHECK(read_back(one.settings)["scenes"] == std::vector<std::string>{"glass"});
}

}  // namespace
}  // namespace raya
